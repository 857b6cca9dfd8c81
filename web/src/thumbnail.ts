// SPDX-License-Identifier: Apache-2.0
// Small pictures of models, drawn from their points.
import { dot, type Vec3 } from "./geometry";
import type { Cloud } from "./protocol";

const kSizePx = 44;

/** Draws a cloud as seen from above its front, nearest points on top. */
export function drawThumbnail(canvas: HTMLCanvasElement, cloud: Cloud, color: [number, number, number]): void {
  canvas.width = kSizePx;
  canvas.height = kSizePx;
  const context = canvas.getContext("2d");
  if (!context) return;
  const right: Vec3 = [0.8, 0.6, 0];
  const up: Vec3 = [-0.3, 0.4, 0.866];
  const toward: Vec3 = [0.52, -0.69, 0.5];
  const count = cloud.positions.length / 3;
  const flat = new Float32Array(3 * count);
  const low = [Infinity, Infinity];
  const high = [-Infinity, -Infinity];
  for (let i = 0; i < count; ++i) {
    const p: Vec3 = [cloud.positions[3 * i] ?? 0, cloud.positions[3 * i + 1] ?? 0, cloud.positions[3 * i + 2] ?? 0];
    const [x, y] = [dot(p, right), dot(p, up)];
    flat.set([x, y, dot(p, toward)], 3 * i);
    [x, y].forEach((value, axis) => {
      low[axis] = Math.min(low[axis] ?? 0, value);
      high[axis] = Math.max(high[axis] ?? 0, value);
    });
  }
  const size = Math.max(1e-6, (high[0] ?? 0) - (low[0] ?? 0), (high[1] ?? 0) - (low[1] ?? 0));
  const scale = (kSizePx - 4) / size;
  const middle = [((low[0] ?? 0) + (high[0] ?? 0)) / 2, ((low[1] ?? 0) + (high[1] ?? 0)) / 2];
  const image = context.createImageData(kSizePx, kSizePx);
  const depth = new Float32Array(kSizePx * kSizePx).fill(-Infinity);
  for (let i = 0; i < count; ++i) {
    const u = Math.round(kSizePx / 2 + scale * ((flat[3 * i] ?? 0) - (middle[0] ?? 0)));
    const v = Math.round(kSizePx / 2 - scale * ((flat[3 * i + 1] ?? 0) - (middle[1] ?? 0)));
    const pixel = v * kSizePx + u;
    const z = flat[3 * i + 2] ?? 0;
    if (u < 0 || v < 0 || u >= kSizePx || v >= kSizePx || z <= (depth[pixel] ?? 0)) continue;
    depth[pixel] = z;
    for (let c = 0; c < 3; ++c) image.data[4 * pixel + c] = cloud.colors?.[3 * i + c] ?? color[c] ?? 128;
    image.data[4 * pixel + 3] = 255;
  }
  context.putImageData(image, 0, 0);
}
