// SPDX-License-Identifier: Apache-2.0
// Rigid motions and pinhole cameras, as in the C++ library. Matrices are 4x4, column by column.
import type { Camera, Pose } from "./protocol";

export type Vec3 = [number, number, number];

const at = (values: ArrayLike<number>, index: number): number => values[index] ?? Number.NaN;

export function transformPoint(m: Pose, p: Vec3): Vec3 {
  const row = (r: number) => at(m, r) * p[0] + at(m, r + 4) * p[1] + at(m, r + 8) * p[2] + at(m, r + 12);
  return [row(0), row(1), row(2)];
}

export function rotateVector(m: Pose, v: Vec3): Vec3 {
  const row = (r: number) => at(m, r) * v[0] + at(m, r + 4) * v[1] + at(m, r + 8) * v[2];
  return [row(0), row(1), row(2)];
}

export function inverseRigid(m: Pose): Pose {
  const t = translationOf(m);
  const column = (c: number): Vec3 => [at(m, 4 * c), at(m, 4 * c + 1), at(m, 4 * c + 2)];
  const [x, y, z] = [column(0), column(1), column(2)];
  return [x[0], y[0], z[0], 0, x[1], y[1], z[1], 0, x[2], y[2], z[2], 0, -dot(x, t), -dot(y, t), -dot(z, t), 1];
}

export function multiply(a: Pose, b: Pose): Pose {
  const result: Pose = [];
  for (let c = 0; c < 4; ++c)
    for (let r = 0; r < 4; ++r) {
      let sum = 0;
      for (let k = 0; k < 4; ++k) sum += at(a, r + 4 * k) * at(b, k + 4 * c);
      result.push(sum);
    }
  return result;
}

export const translationOf = (m: Pose): Vec3 => [at(m, 12), at(m, 13), at(m, 14)];
export const dot = (a: Vec3, b: Vec3): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const subtract = (a: Vec3, b: Vec3): Vec3 => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const distance = (a: Vec3, b: Vec3): number => Math.sqrt(dot(subtract(a, b), subtract(a, b)));

/** Of a point from a box around the origin of a pose; 0 within it. */
export function distanceToBox(point: Vec3, pose: Pose, size: Vec3): number {
  const outside = transformPoint(inverseRigid(pose), point).map((value, i) =>
    Math.max(0, Math.abs(value) - 0.5 * (size[i] ?? 0)),
  );
  return Math.hypot(...outside);
}

/** Angle of the rotation between two poses, in degrees. */
export function rotationAngleDeg(a: Pose, b: Pose): number {
  const r = multiply(inverseRigid(a), b);
  const skew: Vec3 = [at(r, 6) - at(r, 9), at(r, 8) - at(r, 2), at(r, 1) - at(r, 4)];
  const trace = at(r, 0) + at(r, 5) + at(r, 10);
  return (Math.atan2(0.5 * Math.sqrt(dot(skew, skew)), 0.5 * (trace - 1)) * 180) / Math.PI;
}

/** The lower triangle L of C = L L' as a matrix, column by column, for the 3x3 block of the translation in a covariance
 * of 6x6 numbers, row by row. It maps the unit sphere to the surface of one standard deviation. */
export function translationDeviations(covariance: ArrayLike<number>): number[] {
  const c = (i: number, k: number) => at(covariance, 6 * (3 + i) + 3 + k);
  const root = (value: number) => Math.sqrt(Math.max(0, value));
  const over = (value: number, divisor: number) => (divisor > 0 ? value / divisor : 0);
  const l00 = root(c(0, 0));
  const [l10, l20] = [over(c(1, 0), l00), over(c(2, 0), l00)];
  const l11 = root(c(1, 1) - l10 * l10);
  const l21 = over(c(2, 1) - l20 * l10, l11);
  const l22 = root(c(2, 2) - l20 * l20 - l21 * l21);
  return [l00, l10, l20, 0, l11, l21, 0, 0, l22];
}

export function unproject(camera: Camera, u: number, v: number, depth: number): Vec3 {
  return [((u - camera.cx) / camera.fx) * depth, ((v - camera.cy) / camera.fy) * depth, depth];
}

/** Column and row of a point; null behind the camera. */
export function project(camera: Camera, p: Vec3): [number, number] | null {
  if (!(p[2] > 0)) return null;
  return [(camera.fx * p[0]) / p[2] + camera.cx, (camera.fy * p[1]) / p[2] + camera.cy];
}

/** Pixels of a square of four by four, such that the first, the first four and so on are spread evenly. */
const kPhases = [0, 10, 2, 8, 5, 15, 7, 13, 1, 11, 3, 9, 4, 14, 6, 12].map((i) => [i % 4, Math.floor(i / 4)] as const);

/** Points of a depth image (NaN: none) in the world, every `step` pixels in both directions, with their pixels. The
 * first sixteenth of them, the first quarter and so on are spread evenly over the image. */
export function depthToPoints(
  camera: Camera,
  depth: Float32Array,
  worldFromCamera: Pose,
  step: number,
): { positions: Float32Array; pixels: Uint32Array } {
  const capacity = Math.ceil(camera.width / step) * Math.ceil(camera.height / step);
  const positions = new Float32Array(3 * capacity);
  const pixels = new Uint32Array(capacity);
  const m = Float64Array.from(worldFromCamera);
  let count = 0;
  const addPixel = (u: number, v: number) => {
    const z = at(depth, v * camera.width + u);
    if (!(z > 0)) return;
    const x = ((u - camera.cx) / camera.fx) * z;
    const y = ((v - camera.cy) / camera.fy) * z;
    for (let r = 0; r < 3; ++r)
      positions[3 * count + r] = at(m, r) * x + at(m, r + 4) * y + at(m, r + 8) * z + at(m, r + 12);
    pixels[count++] = v * camera.width + u;
  };
  for (const [offsetU, offsetV] of kPhases)
    for (let v = offsetV * step; v < camera.height; v += 4 * step)
      for (let u = offsetU * step; u < camera.width; u += 4 * step) addPixel(u, v);
  return { positions: positions.slice(0, 3 * count), pixels: pixels.slice(0, count) };
}

/** The direction that is up for cameras held upright, snapped to an axis of the world that is within 30 degrees. */
export function guessUp(cameraPoses: Pose[]): Vec3 {
  const sum: Vec3 = [0, 0, 0];
  for (const pose of cameraPoses) for (let r = 0; r < 3; ++r) sum[r] = (sum[r] ?? 0) - at(pose, 4 + r);
  const length = Math.sqrt(dot(sum, sum));
  if (!(length > 1e-6)) return [0, 0, 1];
  for (let r = 0; r < 3; ++r) {
    const share = (sum[r] ?? 0) / length;
    if (Math.abs(share) > 0.8) {
      const axis: Vec3 = [0, 0, 0];
      axis[r] = Math.sign(share);
      return axis;
    }
  }
  return [sum[0] / length, sum[1] / length, sum[2] / length];
}

/** The closest of projected points to a position on the screen, within `radius` pixels; nearer ones win ties of about
 * `radius` pixels. `clipFromPoints` is a projection matrix. */
export function pickPoint(
  positions: ArrayLike<number>,
  clipFromPoints: ArrayLike<number>,
  width: number,
  height: number,
  x: number,
  y: number,
  radius: number,
): { index: number; depth: number } | null {
  const m = clipFromPoints;
  let best: { index: number; depth: number } | null = null;
  let bestCost = Number.POSITIVE_INFINITY;
  for (let i = 0; i + 2 < positions.length; i += 3) {
    const px = at(positions, i);
    const py = at(positions, i + 1);
    const pz = at(positions, i + 2);
    const w = at(m, 3) * px + at(m, 7) * py + at(m, 11) * pz + at(m, 15);
    if (!(w > 0)) continue;
    const dx = ((at(m, 0) * px + at(m, 4) * py + at(m, 8) * pz + at(m, 12)) / w + 1) * 0.5 * width - x;
    if (dx > radius || dx < -radius) continue;
    const dy = (1 - (at(m, 1) * px + at(m, 5) * py + at(m, 9) * pz + at(m, 13)) / w) * 0.5 * height - y;
    const squared = dx * dx + dy * dy;
    if (!(squared <= radius * radius)) continue;
    const cost = w * (1 + (0.1 * Math.sqrt(squared)) / radius);
    if (cost < bestCost) {
      bestCost = cost;
      best = { index: i / 3, depth: w };
    }
  }
  return best;
}

/** Depth of a view less that of points of a surface at a pose, in metres. NaN: not seen. */
export function depthErrors(
  positions: ArrayLike<number>,
  normals: ArrayLike<number> | null,
  cameraFromSurface: Pose,
  camera: Camera,
  depth: ArrayLike<number>,
): Float32Array {
  const errors = new Float32Array(positions.length / 3).fill(Number.NaN);
  for (let i = 0; i < errors.length; ++i) {
    const p = transformPoint(cameraFromSurface, [
      at(positions, 3 * i),
      at(positions, 3 * i + 1),
      at(positions, 3 * i + 2),
    ]);
    if (normals) {
      const n = rotateVector(cameraFromSurface, [at(normals, 3 * i), at(normals, 3 * i + 1), at(normals, 3 * i + 2)]);
      if (dot(n, p) >= 0) continue;
    }
    const pixel = project(camera, p);
    if (!pixel) continue;
    const [u, v] = [Math.round(pixel[0]), Math.round(pixel[1])];
    if (u < 0 || v < 0 || u >= camera.width || v >= camera.height) continue;
    errors[i] = at(depth, v * camera.width + u) - p[2];
  }
  return errors;
}

/** What such an error says of a point: 0 not seen, 1 occluded, 2 present, 3 seen through (docs/glossary.md). Without
 * the noise model of the recogniser: for looking, not for deciding. */
export function classifyError(error: number, marginM: number): 0 | 1 | 2 | 3 {
  if (Number.isNaN(error)) return 0;
  return error < -marginM ? 1 : error > marginM ? 3 : 2;
}
