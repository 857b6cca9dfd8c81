// SPDX-License-Identifier: Apache-2.0
// What became of each hypothesis of a view (`resight recognize --trace`), in words. No page needed.
import { metres, percent } from "./dom";
import { distance, transformPoint, type Vec3 } from "./geometry";
import type { Pose, SceneObject } from "./protocol";

export interface Verification {
  /** Number of a hypothesis of the view; -1: none that is listed. */
  suppressed_by: number;
  /** 0 if it was rejected before. */
  score: number;
  fit: number;
  visible_share: number;
  explained_share: number;
  pattern_similarity: number;
  newest_similarity: number;
  shared_texture: number;
  texture_contrast: number;
  explained_scene: number;
  outlier: number;
  clutter: number;
  plane: number;
  views: { view: number; visible_share: number | null; explained_share: number | null }[];
  /** The first test that failed. */
  test: { quantity: string; value: number; limit: number } | null;
}

export interface Hypothesis {
  /** -1: no object of the page. */
  object: number;
  name: string;
  verdict: string;
  origin_views: number[];
  correspondences: number;
  /** Before refinement. */
  start: Pose;
  pose: Pose;
  verification: Verification | null;
}

/** A true object that was not found. */
export interface Loss {
  object: number;
  name: string;
  pose: Pose;
  visible_share: number | null;
  stage: string;
  keypoints: number;
  correspondences: number;
  right_correspondences: number;
  center_error_m: number | null;
  rotation_error_rad: number | null;
  hypothesis: number;
}

export interface Trace {
  is_searched: boolean;
  num_generated: number;
  num_merged: number;
  num_clustered: number;
  hypotheses: Hypothesis[];
  lost: Loss[];
}

/** The number of a view as it is shown, from 1 on. */
export const viewNumber = (view: number): string => (view < 0 ? "?" : String(view + 1));

const kMarginM = 0.02;
const kDefaultDiameterM = 0.2;

export function centerOf(hypothesis: { pose: Pose }, object: SceneObject | undefined): Vec3 {
  return transformPoint(hypothesis.pose, object?.center ?? [0, 0, 0]);
}

/** The hypotheses that would fill a place, in the order of the trace. */
export function hypothesesAt(trace: Trace, place: Vec3, objects: readonly SceneObject[]): Hypothesis[] {
  return trace.hypotheses.filter((hypothesis) => {
    const object = objects[hypothesis.object];
    const reach = 0.5 * (object?.diameter_m ?? kDefaultDiameterM) + kMarginM;
    const isNear = (pose: Pose) => distance(centerOf({ pose }, object), place) <= reach;
    return isNear(hypothesis.pose) || isNear(hypothesis.start);
  });
}

/** Why a hypothesis was not reported, in one line. */
export function explain(hypothesis: Hypothesis, trace: Trace): string {
  const { verdict, verification } = hypothesis;
  if (verdict === "accepted") return "";
  if (verdict === "held back") return "accepted, but the newest view confirms too little of it";
  if (!verification) return "the changes exclude it, or a deadline left it out";
  if (verification.test) {
    const { quantity, value, limit } = verification.test;
    return quantity === "gain" && limit === 0
      ? `costs more than it explains: gain ${number(value)}`
      : `${quantity} ${number(value)}, needs ${number(limit)}`;
  }
  if (verdict !== "suppressed") return "the best set of hypotheses does without it";
  const by = trace.hypotheses[verification.suppressed_by];
  return by ? `does not pay beside ${by.name}` : "does not pay beside another hypothesis";
}

const kStages: Record<string, string> = {
  "no keypoints": "too few keypoints on what is visible of it",
  "no matches": "its keypoints were not matched to the right places of its model",
  "no group": "right matches, but no hypothesis near it",
  "wrong pose": "hypotheses near it, but none with the right pose",
  "clustered out": "a right hypothesis was merged into a wrong one",
  "called absent": "a right hypothesis was excluded by changes, left out, too unlikely, or taken for another object",
  "refined away": "a right hypothesis was moved away by the refinement",
  rejected: "a right hypothesis was rejected",
};

/** Where a missed object was lost: lines of a name and a value. */
export function lossRows(loss: Loss): [string, string][] {
  const rows: [string, string][] = [
    ["lost at", loss.stage],
    ["that is", kStages[loss.stage] ?? "unknown"],
    ["visible", percent(loss.visible_share)],
    ["keypoints on it", String(loss.keypoints)],
    ["matches", `${loss.correspondences}, ${loss.right_correspondences} of them right`],
  ];
  if (loss.center_error_m !== null && loss.rotation_error_rad !== null) {
    const degrees = ((loss.rotation_error_rad * 180) / Math.PI).toFixed(1);
    rows.push(["best hypothesis", `${metres(loss.center_error_m)}, ${degrees}° off`]);
  }
  return rows;
}

/** The evidence of a hypothesis: lines of a name and a value. */
export function evidenceRows(hypothesis: Hypothesis): [string, string][] {
  const from = hypothesis.origin_views.map(viewNumber).join(", ");
  const rows: [string, string][] = [["from views", `${from || "–"} (${hypothesis.correspondences} matches)`]];
  const v = hypothesis.verification;
  if (!v) return rows;
  rows.push(
    ["score", v.score > 0 ? number(v.score) : "–"],
    ["fit", percent(v.fit)],
    ["visible", percent(v.visible_share)],
    ["explained", percent(v.explained_share)],
    ["pattern", `${number(v.pattern_similarity)}, newest view ${number(v.newest_similarity)}`],
    ["texture", `${number(v.shared_texture)} of ${number(v.texture_contrast)} shared`],
    ["gain", `${v.explained_scene.toFixed(0)} explained`],
    ["cost", `${v.outlier.toFixed(0)} outlier, ${v.clutter.toFixed(0)} clutter, ${v.plane.toFixed(0)} plane`],
  );
  const views = v.views.map(
    (each) => `${viewNumber(each.view)}: ${percent(each.visible_share)}/${percent(each.explained_share)}`,
  );
  if (views.length > 0) rows.push(["visible/explained", views.join(" · ")]);
  return rows;
}

const number = (value: number | null): string =>
  value === null ? "–" : Math.abs(value) >= 10 ? value.toFixed(0) : value.toFixed(2);
