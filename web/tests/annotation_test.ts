// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { test } from "node:test";
import {
  type Annotation,
  beginAt,
  endBefore,
  type Placement,
  placementAt,
  placementBeside,
  presentInterval,
  type Region,
  splitAt,
  toRun,
  unknownEnds,
  type ViewResidual,
} from "../src/annotation";
import { multiply, transformPoint, type Vec3 } from "../src/geometry";
import {
  fromNumbers,
  isSamePose,
  movePose,
  nextSymmetryStep,
  rotation,
  toNumbers,
  translation,
  turnPose,
  withNumber,
} from "../src/pose_edit";

const isNear = (a: number[], b: number[]) => a.every((value, i) => Math.abs(value - (b[i] ?? 0)) < 1e-9);
const kCenter: Vec3 = [0.1, -0.2, 0.3];

test("six numbers give the pose back, also where two axes coincide", () => {
  for (const numbers of [
    [1, 2, 3, 10, 20, 30],
    [-500, 0, 1200, -170, 80, 175],
    [0, 0, 0, 0, 90, 40],
  ]) {
    const pose = fromNumbers(numbers, kCenter);
    assert.ok(pose);
    const again = fromNumbers(toNumbers(pose, kCenter), kCenter);
    assert.ok(again && isNear(again, pose));
  }
  assert.equal(fromNumbers([1, 2, 3, 4, 5, Number.NaN], kCenter), null);
});

test("the centre stays where it is when an object turns", () => {
  const pose = movePose(rotation([0, 0, 1], 30), [1, 0, 0], 0.5, "world");
  for (const axes of ["world", "object"] as const) {
    const turned = turnPose(pose, kCenter, [0, 1, 0], 25, axes);
    assert.ok(isNear(transformPoint(turned, kCenter), transformPoint(pose, kCenter)));
  }
  const alongOwnAxis = movePose(rotation([0, 0, 1], 90), [1, 0, 0], 0.5, "object");
  assert.ok(isNear(alongOwnAxis.slice(12, 15), [0, 0.5, 0]));
});

test("one number changes alone", () => {
  const pose = fromNumbers([1.234567, 2, 3, 10.000123, 20, 30], kCenter) ?? [];
  assert.ok(isNear(withNumber(pose, kCenter, 0, 7) ?? [], fromNumbers([7, 2, 3, 10.000123, 20, 30], kCenter) ?? [9]));
  assert.equal(withNumber(pose, kCenter, 3, Number.NaN), null);
});

test("steps of symmetry reach all poses of the same shape, and return to the first one", () => {
  const [turn, half] = [rotation([0, 0, 1], 90), rotation([1, 0, 0], 180)];
  const group = [0, 1, 2, 3].flatMap((i) => {
    const turned = rotation([0, 0, 1], 90 * i);
    return [turned, multiply(half, turned)];
  });
  assert.ok(isSamePose(group[2] ?? [], turn));
  const start = turnPose(translation([1, 2, 3]), kCenter, [0, 1, 0], 33, "world");
  const reached: number[][] = [];
  let pose = start;
  group.forEach((_, index) => {
    pose = multiply(pose, nextSymmetryStep(group.slice(1), index));
    if (!reached.some((other) => isSamePose(other, pose))) reached.push(pose);
  });
  assert.equal(reached.length, group.length);
  assert.ok(isSamePose(pose, start));
});

const placement = (id: number, track: number, first_view: number, last_view: number): Placement => ({
  id,
  track,
  object: 0,
  first_view,
  last_view,
  pose: translation([id, 0, 0]),
});

test("an annotation is shown as a run", () => {
  const annotation: Annotation = {
    revision: 3,
    undo: "",
    redo: "",
    objects: [placement(0, 5, 0, 1), placement(1, 5, 2, 3), placement(2, 6, 1, 3)],
    checked_views: [],
    regions: [],
    events: [{ view: 2, kind: "moved", track: 5, object: 0, name: "cup", before: null, after: null }],
    unknown_events: [],
    to_dos: [],
  };
  const run = toRun(annotation, [null, null, null, null]);
  assert.deepEqual(
    run.views.map((view) => view?.detections.length),
    [1, 2, 2, 2],
  );
  assert.equal(run.events.length, 1);
  assert.equal(placementAt(annotation, 5, 1)?.id, 0);
  assert.equal(placementAt(annotation, 5, 3)?.id, 1);
  assert.equal(placementAt(annotation, 6, 0)?.id, 2);
  assert.equal(placementAt(annotation, 9, 0), null);
});

test("an object came, left or moved before a view", () => {
  const there = placement(4, 2, 1, 3);
  const begin = (view: number, others: Placement[] = []) => beginAt(there, view, [there, ...others], 9);
  assert.deepEqual(begin(2), { ...there, first_view: 2 });
  assert.deepEqual(begin(0), { ...there, first_view: 0 });
  assert.deepEqual(begin(4), { ...there, id: -1, first_view: 4, last_view: 8 }, "it came back: another placement");
  assert.deepEqual(begin(4, [placement(5, 2, 7, 8), placement(6, 3, 5, 8)]).last_view, 6, "up to its next one");
  assert.deepEqual(endBefore(there, 3), { ...there, last_view: 2 });
  assert.throws(() => endBefore(there, 1), /delete it/);
  assert.deepEqual(splitAt(there, 2), [
    { ...there, last_view: 1 },
    { ...there, id: -1, first_view: 2 },
  ]);
  for (const view of [0, 1, 4]) assert.throws(() => splitAt(there, view), /after the move/);
});

test("a region comes from a placement of its view, or from one before if something left", () => {
  const objects = [placement(0, 5, 0, 1), placement(1, 5, 2, 3), placement(2, 6, 2, 2)];
  const annotation = { objects } as Annotation;
  const idBeside = (track: number, kind: "novel" | "removed", view: number) =>
    placementBeside(annotation, track, { kind, view } as Region)?.id;
  assert.deepEqual([idBeside(5, "novel", 2), idBeside(5, "removed", 2)], [1, 0]);
  assert.deepEqual([idBeside(6, "novel", 2), idBeside(6, "removed", 2)], [2, undefined]);
  assert.deepEqual([idBeside(6, "novel", 3), idBeside(6, "removed", 3)], [undefined, 2]);
  assert.deepEqual([idBeside(6, "novel", 1), idBeside(9, "novel", 2)], [undefined, undefined]);
});

test("free space bounds the views in which an object is there", () => {
  const residual = (view: number, is_gone: boolean): ViewResidual => ({
    view,
    num_visible: 100,
    supported_share: is_gone ? 0 : 1,
    median_mm: 1,
    is_informative: true,
    is_gone,
    is_used: !is_gone,
  });
  const residuals = [true, false, false, true, false].map((isGone, view) => residual(view, isGone));
  assert.deepEqual(presentInterval(residuals, 2, 5), [1, 2]);
  assert.deepEqual(presentInterval(residuals, 4, 5), [4, 4]);
  assert.deepEqual(presentInterval([], 2, 5), [0, 4]);

  const spread = [true, false, false, false, true].map((isGone, i) => residual(5 * i, isGone));
  assert.deepEqual(unknownEnds(spread, 10, 21), [
    [1, 4],
    [16, 19],
  ]);
  assert.deepEqual(unknownEnds(spread, 2, 21), [
    [1, 1],
    [16, 19],
  ]);
  assert.deepEqual(unknownEnds(spread.slice(1, 4), 10, 21), [], "it is there from the first view to the last");
  assert.deepEqual(unknownEnds([...spread, residual(1, false), residual(19, true), residual(18, false)], 10, 21), []);
});
