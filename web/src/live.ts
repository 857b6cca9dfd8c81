// SPDX-License-Identifier: Apache-2.0
// Follows a run that is still at work. No page needed.

/** So many attempts in a row may fail; with kPauseMs between them, a computer that slept a while is waited for. */
export const kMaxFailures = 10;
const kPauseMs = 1000;

/** What is shown of the run. */
export interface Shown {
  revision: () => number;
  isLive: () => boolean;
  reload: () => Promise<void>;
}

/** Loads again at each revision that is newer than what is shown, until the run is over. Those that waited while a newer
 * one was loaded are passed over. Connects again where the stream ends or fails, and throws what the last of too many
 * failures in a row has thrown. */
export async function follow(revisions: () => AsyncIterable<number>, shown: Shown, pauseMs = kPauseMs): Promise<void> {
  for (let numFailures = 0; ; ) {
    try {
      for await (const revision of revisions()) {
        if (revision > shown.revision()) await shown.reload();
        if (!shown.isLive()) return;
        numFailures = 0;
      }
    } catch (error) {
      if (++numFailures >= kMaxFailures) throw error;
    }
    await new Promise((resolve) => setTimeout(resolve, pauseMs));
  }
}
