// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { test } from "node:test";
import { translation } from "../src/pose_edit";
import type { SceneObject } from "../src/protocol";
import {
  evidenceRows,
  explain,
  type Hypothesis,
  hypothesesAt,
  lossRows,
  type Trace,
  type Verification,
} from "../src/trace";

const kMug: SceneObject = {
  name: "mug",
  obj_id: 1,
  color: "#fff",
  has_surface: true,
  center: [0, 0, 0.05],
  diameter_m: 0.1,
};

const verification = (change: Partial<Verification> = {}): Verification => ({
  suppressed_by: -1,
  score: 0.6,
  fit: 0.5,
  visible_share: 0.25,
  explained_share: 0.55,
  pattern_similarity: 0.1,
  newest_similarity: 1,
  shared_texture: 0,
  texture_contrast: 3,
  explained_scene: 120,
  outlier: 30,
  clutter: 4,
  plane: 0,
  views: [{ view: 3, visible_share: 0.25, explained_share: null }],
  test: null,
  ...change,
});
const hypothesis = (verdict: string, x: number, found: Verification | null = verification()): Hypothesis => ({
  object: 0,
  name: "mug",
  verdict,
  origin_views: [1, 3],
  correspondences: 7,
  start: translation([x, 0, 0]),
  pose: translation([x, 0, 0]),
  verification: found,
});
const trace = (...hypotheses: Hypothesis[]): Trace => ({
  is_searched: true,
  num_generated: 3,
  num_merged: 3,
  num_clustered: 2,
  hypotheses,
  lost: [],
});

test("a place has the hypotheses that would fill it, before or after refinement", () => {
  const [here, beside, away] = [hypothesis("accepted", 0), hypothesis("cost", 0.06), hypothesis("cost", 0.2)];
  const moved = { ...hypothesis("no support", 0.3), start: translation([0.01, 0, 0]) };
  const found = hypothesesAt(trace(here, beside, away, moved), [0, 0, 0.05], [kMug]);
  assert.deepEqual(found, [here, beside, moved]);
  assert.deepEqual(hypothesesAt(trace({ ...here, object: -1 }), [0, 0, 0], [kMug]).length, 1, "an unknown object");
});

test("each verdict is explained with its numbers", () => {
  const test = { quantity: "explained share", value: 0.55, limit: 0.7 };
  const rejected = hypothesis("no support", 0, verification({ test }));
  const suppressed = hypothesis("suppressed", 0, verification({ suppressed_by: 0 }));
  const all = trace(rejected, suppressed);
  assert.equal(explain(rejected, all), "explained share 0.55, needs 0.70");
  assert.equal(explain(suppressed, all), "does not pay beside mug");
  assert.equal(explain(hypothesis("suppressed", 0), all), "does not pay beside another hypothesis");
  assert.match(explain(hypothesis("not verified", 0, null), all), /changes exclude it/);
  assert.match(explain(hypothesis("held back", 0), all), /newest view/);
  assert.equal(explain(hypothesis("accepted", 0), all), "");
  const gain = { quantity: "gain", value: -12.4, limit: 0 };
  assert.equal(
    explain(hypothesis("cost", 0, verification({ test: gain })), all),
    "costs more than it explains: gain -12",
  );
});

test("evidence and losses are listed, unknown numbers as such", () => {
  const rows = new Map(evidenceRows(hypothesis("cost", 0)));
  assert.equal(rows.get("from views"), "2, 4 (7 matches)");
  assert.equal(rows.get("visible/explained"), "4: 25 %/–");
  assert.equal(evidenceRows(hypothesis("not verified", 0, null)).length, 1);
  const unknown = new Map(evidenceRows({ ...hypothesis("cost", 0), origin_views: [-1, 0] }));
  assert.equal(unknown.get("from views"), "?, 1 (7 matches)");
  const loss = {
    object: 0,
    name: "mug",
    pose: translation([0, 0, 0]),
    visible_share: null,
    stage: "wrong pose",
    keypoints: 12,
    correspondences: 9,
    right_correspondences: 2,
    center_error_m: 0.08,
    rotation_error_rad: Math.PI / 2,
    hypothesis: -1,
  };
  const lost = new Map(lossRows(loss));
  assert.equal(lost.get("lost at"), "wrong pose");
  assert.equal(lost.get("best hypothesis"), "80 mm, 90.0° off");
  assert.equal(new Map(lossRows({ ...loss, center_error_m: null })).has("best hypothesis"), false);
});
