// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import test from "node:test";
import { findChanges, findTracks, neighbourChange } from "../src/history";
import type { Detection, EventKind, ObjectEvent, Run } from "../src/protocol";

function detection(track: number, object: number): Detection {
  return { object, track, score: 1, fit: 1, visible_share: 1, verdict: "", pose: [] };
}
function event(view: number, kind: EventKind, track: number): ObjectEvent {
  return { view, kind, object: track, track, before: null, after: null, confidence: 1 };
}
function makeRun(views: (number[] | null)[], events: ObjectEvent[]): Run {
  return {
    name: "run",
    preset: "default",
    version: "1",
    events,
    views: views.map(
      (tracks) =>
        tracks && {
          pose: [],
          detections: tracks.map((track) => detection(track, track)),
          novel_points: 0,
          removed_points: 0,
          changed_share: 0,
          pose_suspect: false,
        },
    ),
  };
}

test("spans end where an object is not detected, not where there are no results", () => {
  const run = makeRun([[1], [1, 2], null, [1], [2], [1]], [event(4, "removed", 3)]);
  const tracks = findTracks(run);
  assert.deepEqual(
    tracks.map((track) => [track.track, track.spans.map((span) => [span.first, span.last])]),
    [
      [
        1,
        [
          [0, 3],
          [5, 5],
        ],
      ],
      [
        2,
        [
          [1, 1],
          [4, 4],
        ],
      ],
      [3, []],
    ],
  );
  assert.equal(tracks[2]?.events.length, 1);
});

test("two objects of a kind in one view are two tracks", () => {
  assert.equal(findTracks(makeRun([[1, 2]], [])).length, 2);
  assert.deepEqual(findTracks(makeRun([], [])), []);
});

test("changes are stepped through one by one, also within a view", () => {
  const events = [event(0, "found", 1), event(2, "added", 2), event(2, "moved", 1), event(5, "removed", 2)];
  const changes = findChanges(makeRun([], events));
  assert.equal(changes.length, 3);
  const [added, moved, removed] = changes;
  assert.ok(added && moved && removed);
  assert.equal(neighbourChange(changes, 0, null, 1), added);
  assert.equal(neighbourChange(changes, 2, added, 1), moved);
  assert.equal(neighbourChange(changes, 2, moved, 1), removed);
  assert.equal(neighbourChange(changes, 5, removed, 1), null);
  assert.equal(neighbourChange(changes, 5, removed, -1), moved);
  assert.equal(neighbourChange(changes, 4, added, 1), removed, "the user has gone to another view since");
  assert.equal(neighbourChange(changes, 0, null, -1), null);
});
