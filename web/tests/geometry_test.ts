// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import test from "node:test";
import { errorColors, kErrorColors, kEvidenceColors, parseColor } from "../src/colors";
import {
  classifyError,
  depthErrors,
  depthToPoints,
  distance,
  distanceToBox,
  guessUp,
  inverseRigid,
  multiply,
  pickPoint,
  project,
  rotationAngleDeg,
  transformPoint,
  translationDeviations,
  unproject,
  type Vec3,
} from "../src/geometry";
import type { Camera, Pose } from "../src/protocol";

const kCamera: Camera = { width: 4, height: 3, fx: 5, fy: 5, cx: 1.5, cy: 1 };
const kIdentity: Pose = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];

/** A rotation about z, and a translation. */
function pose(degrees: number, t: Vec3): Pose {
  const [c, s] = [Math.cos((degrees * Math.PI) / 180), Math.sin((degrees * Math.PI) / 180)];
  return [c, s, 0, 0, -s, c, 0, 0, 0, 0, 1, 0, ...t, 1];
}

function assertNear(a: readonly number[], b: readonly number[]): void {
  assert.equal(a.length, b.length);
  a.forEach((value, i) => {
    assert.ok(Math.abs(value - (b[i] ?? Number.NaN)) < 1e-9, `${a} is not ${b}`);
  });
}

test("deviations of a translation map the unit sphere to its covariance", () => {
  const block = [4, 2, -1, 2, 5, 0.5, -1, 0.5, 3];
  const covariance = Array.from({ length: 36 }, (_, i) => {
    const [row, column] = [Math.floor(i / 6) - 3, (i % 6) - 3];
    return row >= 0 && column >= 0 ? (block[3 * row + column] ?? 0) : 77;
  });
  const l = translationDeviations(covariance);
  const at = (row: number, column: number) => l[3 * column + row] ?? 0;
  for (let row = 0; row < 3; ++row)
    for (let column = 0; column < 3; ++column) {
      const sum = [0, 1, 2].reduce((total, k) => total + at(row, k) * at(column, k), 0);
      assert.ok(Math.abs(sum - (block[3 * row + column] ?? 0)) < 1e-12);
    }
  assert.deepEqual(translationDeviations(new Array(36).fill(0)), new Array(9).fill(0), "no uncertainty");
});

test("a motion and its inverse cancel", () => {
  const a = pose(30, [1, 2, 3]);
  assertNear(multiply(a, inverseRigid(a)), kIdentity);
  assertNear(transformPoint(inverseRigid(a), transformPoint(a, [4, 5, 6])), [4, 5, 6]);
  assertNear(transformPoint(pose(90, [0, 0, 1]), [1, 0, 0]), [0, 1, 1]);
});

test("a point is in a turned box, or as far from it as from its nearest face or corner", () => {
  const pose: Pose = [0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 1, 2, 3, 1]; // a quarter turn about z
  const size: [number, number, number] = [2, 4, 6];
  assert.equal(distanceToBox([1, 2, 3], pose, size), 0);
  assert.equal(distanceToBox([2.9, 2.9, 5.9], pose, size), 0);
  assert.ok(Math.abs(distanceToBox([1, 5, 3], pose, size) - 2) < 1e-12);
  assert.ok(Math.abs(distanceToBox([6, 7, 3], pose, size) - 5) < 1e-12);
});

test("angles between poses do not depend on the frame", () => {
  assertNear([rotationAngleDeg(pose(10, [0, 0, 0]), pose(35, [1, 1, 1]))], [25]);
  assertNear([rotationAngleDeg(kIdentity, kIdentity)], [0]);
  assertNear([distance([1, 2, 3], [1, 5, 7])], [5]);
});

test("projection inverts unprojection", () => {
  assertNear(project(kCamera, unproject(kCamera, 3, 2, 1.7)) ?? [], [3, 2]);
  assert.equal(project(kCamera, [0, 0, -1]), null);
});

test("pixels without depth give no points", () => {
  const depth = new Float32Array(12).fill(2);
  depth[5] = Number.NaN;
  const { positions, pixels } = depthToPoints(kCamera, depth, pose(90, [0, 0, 1]), 1);
  assert.equal(pixels.length, 11);
  assert.ok(!pixels.includes(5));
  const i = pixels.indexOf(11);
  const expected = transformPoint(pose(90, [0, 0, 1]), unproject(kCamera, 3, 2, 2));
  expected.forEach((value, axis) => {
    assert.ok(Math.abs(value - (positions[3 * i + axis] ?? 0)) < 1e-6);
  });
  assert.equal(depthToPoints(kCamera, depth, kIdentity, 2).pixels.length, 4);
});

test("up is against the y axes of the cameras, along an axis of the world if it is near", () => {
  assertNear(guessUp([kIdentity]), [0, -1, 0]);
  const looksDown: Pose = [1, 0, 0, 0, 0, -0.5, -0.866, 0, 0, 0.866, -0.5, 0, 0, 0, 0, 1];
  assertNear(guessUp([looksDown]), [0, 0, 1]);
  assertNear(guessUp([]), [0, 0, 1]);
});

test("the nearest point within the radius is picked", () => {
  const w: Pose = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0]; // x/z, y/z
  const positions = [0, 0, 2, 0.001, 0, 1, 0.5, 0.5, 1, 0, 0, -1];
  assert.equal(pickPoint(positions, w, 100, 100, 50, 50, 5)?.index, 1);
  assert.equal(pickPoint(positions, w, 100, 100, 75, 25, 5)?.index, 2);
  assert.equal(pickPoint(positions, w, 100, 100, 10, 10, 5), null);
});

test("a surface is occluded, present or seen through by what is measured", () => {
  const depth = new Float32Array(12).fill(1);
  const points: Vec3[] = [
    unproject(kCamera, 0, 0, 1.3),
    unproject(kCamera, 1, 0, 1.01),
    unproject(kCamera, 2, 0, 0.8),
    unproject(kCamera, 9, 0, 1),
  ];
  const errors = depthErrors(points.flat(), null, kIdentity, kCamera, depth);
  assertNear(
    [...errors.subarray(0, 3)].map((error) => Math.round(1e6 * error) / 1e6),
    [-0.3, -0.01, 0.2],
  );
  assert.deepEqual(
    [...errors].map((error) => classifyError(error, 0.015)),
    [1, 2, 3, 0],
  );
  const away = depthErrors(points.flat(), new Array(4).fill([0, 0, 1]).flat(), kIdentity, kCamera, depth);
  assert.ok(away.every(Number.isNaN), "sides that face away are not seen");
});

test("errors of depth are blue where the view is nearer, red where it is farther, grey where it says nothing", () => {
  const colors = errorColors(new Float32Array([-0.03, 0, 0.015, Number.NaN]), 0.015);
  const expected = [kErrorColors[0], kErrorColors[1], kErrorColors[2], kEvidenceColors[0]].flatMap(parseColor);
  assert.deepEqual([...colors], expected);
});
