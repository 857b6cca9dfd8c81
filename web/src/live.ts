// SPDX-License-Identifier: Apache-2.0
// Follows a run that is still at work. No page needed.

/** So many attempts in a row may fail; with kPauseMs between them, a computer that slept a while is waited for. */
export const kMaxFailures = 10;
const kPauseMs = 1000;

/** Gives each revision to `onRevision` until that answers that none follows. Connects again where the stream ends or
 * fails, and throws what the last of too many failures in a row has thrown. */
export async function follow(
  revisions: () => AsyncIterable<number>,
  onRevision: (revision: number) => Promise<boolean>,
  pauseMs = kPauseMs,
): Promise<void> {
  for (let numFailures = 0; ; ) {
    try {
      for await (const revision of revisions()) {
        if (!(await onRevision(revision))) return;
        numFailures = 0;
      }
    } catch (error) {
      if (++numFailures >= kMaxFailures) throw error;
    }
    await new Promise((resolve) => setTimeout(resolve, pauseMs));
  }
}
