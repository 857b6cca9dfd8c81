// SPDX-License-Identifier: Apache-2.0
import { classifyError } from "./geometry";

type Rgb = [number, number, number];

/** Colours of what a view says of a surface: not seen, occluded, present, seen through. The last two differ in
 * brightness as well, for who does not tell red from green. */
export const kEvidenceColors = ["#8b949e", "#3e7bfa", "#6fdc9c", "#c1272d"] as const;

/** Colours of errors of depth: the view is nearer than the model by the limit, as near, farther by the limit. */
export const kErrorColors = ["#3e7bfa", "#f2f2f2", "#e5484d"] as const;

/** A colour per error; grey for NaN. */
export function errorColors(errors: Float32Array, limit: number): Uint8Array {
  const [nearer, same, farther] = kErrorColors.map(parseColor) as [Rgb, Rgb, Rgb];
  const unseen = parseColor(kEvidenceColors[0]);
  const colors = new Uint8Array(3 * errors.length);
  for (const [i, error] of errors.entries()) {
    const isSeen = !Number.isNaN(error);
    const share = isSeen ? Math.min(1, Math.abs(error) / limit) : 1;
    const end = !isSeen ? unseen : error < 0 ? nearer : farther;
    for (let c = 0; c < 3; ++c) colors[3 * i + c] = (1 - share) * (same[c] ?? 0) + share * (end[c] ?? 0);
  }
  return colors;
}

/** A colour per error by what it says (classifyError()). */
export function evidenceColors(errors: Float32Array, margin: number): Uint8Array {
  const palette = kEvidenceColors.map(parseColor);
  const colors = new Uint8Array(3 * errors.length);
  for (const [i, error] of errors.entries()) colors.set(palette[classifyError(error, margin)] ?? [0, 0, 0], 3 * i);
  return colors;
}

/** Colours of n points, all the same. */
export function plainColors(count: number, color: string): Uint8Array {
  const rgb = parseColor(color);
  const colors = new Uint8Array(3 * count);
  for (let i = 0; i < colors.length; ++i) colors[i] = rgb[i % 3] ?? 0;
  return colors;
}

/** Red, green and blue of #rrggbb. */
export function parseColor(color: string): Rgb {
  const value = Number.parseInt(color.slice(1), 16);
  return [(value >> 16) & 255, (value >> 8) & 255, value & 255];
}

/** A colour per distance, from near (warm) to far (cold). */
export function distanceColors(distances: Float32Array, near: number, far: number): Uint8Array {
  const stops = [
    [240, 90, 50],
    [245, 190, 60],
    [110, 200, 110],
    [50, 150, 210],
    [70, 70, 170],
  ];
  const colors = new Uint8Array(3 * distances.length);
  for (let i = 0; i < distances.length; ++i) {
    const share = Math.max(0, Math.min(0.9999, ((distances[i] ?? 0) - near) / (far - near || 1)));
    const position = share * (stops.length - 1);
    const index = Math.floor(position);
    const [a = [], b = []] = [stops[index], stops[index + 1]];
    for (let c = 0; c < 3; ++c) colors[3 * i + c] = (a[c] ?? 0) + ((b[c] ?? 0) - (a[c] ?? 0)) * (position - index);
  }
  return colors;
}
