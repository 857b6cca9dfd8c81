// SPDX-License-Identifier: Apache-2.0
// Poses as six numbers, and small motions of them. Matrices are 4x4, column by column. No page needed.
import { inverseRigid, multiply, transformPoint, translationOf, type Vec3 } from "./geometry";
import type { Pose } from "./protocol";

const kDegree = Math.PI / 180;
const kSamePose = 1e-9;

/** Rotation about a unit axis through the origin. */
export function rotation(axis: Vec3, degrees: number): Pose {
  const [x, y, z] = axis;
  const [c, s] = [Math.cos(degrees * kDegree), Math.sin(degrees * kDegree)];
  const d = 1 - c;
  return [
    c + x * x * d,
    y * x * d + z * s,
    z * x * d - y * s,
    0,
    x * y * d - z * s,
    c + y * y * d,
    z * y * d + x * s,
    0,
    x * z * d + y * s,
    y * z * d - x * s,
    c + z * z * d,
    0,
    0,
    0,
    0,
    1,
  ];
}

export const translation = (by: Vec3): Pose => [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, by[0], by[1], by[2], 1];

export const isSamePose = (a: Pose, b: Pose): boolean =>
  a.every((value, i) => Math.abs(value - (b[i] ?? 0)) < kSamePose);

/** From the pose of symmetry `index` to that of the next one. Symmetry 0 is the identity, number i is `motions[i - 1]`;
 * after the last one comes the identity again. Right of a pose, as motions of the object are. */
export function nextSymmetryStep(motions: readonly Pose[], index: number): Pose {
  const poses = [translation([0, 0, 0]), ...motions];
  const at = (i: number) => poses[i % poses.length] ?? translation([0, 0, 0]);
  return multiply(inverseRigid(at(index)), at(index + 1));
}

export type Axes = "world" | "object";

/** Moves a pose along an axis of the world or of the object. */
export function movePose(pose: Pose, axis: Vec3, metres: number, axes: Axes): Pose {
  const by = axis.map((value) => value * metres) as Vec3;
  return axes === "world" ? multiply(translation(by), pose) : multiply(pose, translation(by));
}

/** Turns a pose about a point of the object, around an axis of the world or of the object. */
export function turnPose(pose: Pose, center: Vec3, axis: Vec3, degrees: number, axes: Axes): Pose {
  const back = center.map((value) => -value) as Vec3;
  if (axes === "object")
    return multiply(pose, multiply(translation(center), multiply(rotation(axis, degrees), translation(back))));
  const fixed = transformPoint(pose, center);
  const toOrigin = translation(fixed.map((value) => -value) as Vec3);
  return multiply(translation(fixed), multiply(rotation(axis, degrees), multiply(toOrigin, pose)));
}

/** Position of the centre in mm, and angles about x, y and z in degrees: the rotation is Rz Ry Rx. */
export function toNumbers(pose: Pose, center: Vec3): number[] {
  const at = (i: number) => pose[i] ?? 0;
  const y = Math.asin(Math.max(-1, Math.min(1, -at(2))));
  const isFlat = Math.abs(at(2)) < 1 - 1e-9;
  const x = isFlat ? Math.atan2(at(6), at(10)) : 0;
  const z = isFlat ? Math.atan2(at(1), at(0)) : Math.atan2(-at(4), at(5));
  return [...transformPoint(pose, center).map((value) => 1000 * value), x / kDegree, y / kDegree, z / kDegree];
}

/** Inverse of toNumbers(); null unless all six numbers are finite. */
export function fromNumbers(numbers: number[], center: Vec3): Pose | null {
  if (numbers.length !== 6 || !numbers.every((value) => Number.isFinite(value))) return null;
  const [px = 0, py = 0, pz = 0, x = 0, y = 0, z = 0] = numbers;
  const turned = multiply(rotation([0, 0, 1], z), multiply(rotation([0, 1, 0], y), rotation([1, 0, 0], x)));
  const moved = translationOf(multiply(turned, translation(center)));
  return multiply(translation([px / 1000 - moved[0], py / 1000 - moved[1], pz / 1000 - moved[2]]), turned);
}

/** A pose with one of its six numbers changed; null unless that one is finite. */
export function withNumber(pose: Pose, center: Vec3, index: number, value: number): Pose | null {
  const numbers = toNumbers(pose, center);
  numbers[index] = value;
  return fromNumbers(numbers, center);
}
