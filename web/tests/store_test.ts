// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import test from "node:test";
import { App } from "../src/store";

function appOf(numViews: number): App {
  return new App({
    title: "",
    revision: 0,
    is_live: false,
    has_poses: false,
    has_truth: false,
    has_changes: false,
    views: Array.from({ length: numViews }, (_, view) => ({ name: String(view), pose: null })),
    objects: [],
    runs: [],
  });
}

test("several views are played and paused, a single one is not", () => {
  const [several, single] = [appOf(2), appOf(1)];
  several.togglePlaying();
  single.togglePlaying();
  assert.equal(several.get().isPlaying, true);
  assert.equal(single.get().isPlaying, false);
  several.togglePlaying();
  assert.equal(several.get().isPlaying, false);
});
