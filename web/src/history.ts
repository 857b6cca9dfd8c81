// SPDX-License-Identifier: Apache-2.0
// What happened to each object of a run, for the timeline.
import type { EventKind, ObjectEvent, Run } from "./protocol";

/** Views from `first` to `last` in which a track was detected, one after the other. */
export interface Span {
  first: number;
  last: number;
}

export interface Track {
  track: number;
  object: number;
  spans: Span[];
  events: ObjectEvent[];
}

export const isChange = (kind: EventKind): boolean => kind === "added" || kind === "moved" || kind === "removed";

/** The tracks of a run, by the view in which they appear first. Views without results do not part a span. */
export function findTracks(run: Run): Track[] {
  const tracks = new Map<number, Track>();
  const open = new Map<number, Span>();
  let previous = -1;
  run.views.forEach((view, number) => {
    if (!view) return;
    for (const detection of view.detections) {
      let track = tracks.get(detection.track);
      if (!track) {
        track = { track: detection.track, object: detection.object, spans: [], events: [] };
        tracks.set(detection.track, track);
      }
      const span = open.get(detection.track);
      if (span && (span.last === previous || span.last === number)) {
        span.last = number;
      } else {
        const started = { first: number, last: number };
        open.set(detection.track, started);
        track.spans.push(started);
      }
    }
    previous = number;
  });
  for (const event of run.events) {
    const track = tracks.get(event.track);
    if (track) track.events.push(event);
    else tracks.set(event.track, { track: event.track, object: event.object, spans: [], events: [event] });
  }
  const start = (track: Track) => Math.min(track.spans[0]?.first ?? 1e9, track.events[0]?.view ?? 1e9);
  return [...tracks.values()].sort((a, b) => start(a) - start(b) || a.track - b.track);
}

/** The changes of a run, in order: what a user steps through. */
export const findChanges = (run: Run | undefined): ObjectEvent[] =>
  run ? run.events.filter((event) => isChange(event.kind)) : [];

/** The change after (direction 1) or before (-1) an event or, if none is selected, a view. */
export function neighbourChange(
  changes: ObjectEvent[],
  view: number,
  selected: ObjectEvent | null,
  direction: 1 | -1,
): ObjectEvent | null {
  const index = selected ? changes.indexOf(selected) : -1;
  if (index >= 0 && selected?.view === view) return changes[index + direction] ?? null;
  if (direction > 0) return changes.find((event) => event.view > view) ?? null;
  return changes.filter((event) => event.view < view).pop() ?? null;
}

export const kEventNames: Record<EventKind, string> = {
  found: "found",
  added: "added",
  moved: "moved",
  removed: "removed",
  still_there: "still there",
  not_seen: "not seen",
};

export const kEventMarks: Record<EventKind, string> = {
  found: "•",
  added: "+",
  moved: "→",
  removed: "−",
  still_there: "·",
  not_seen: "?",
};
