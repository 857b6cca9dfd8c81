// SPDX-License-Identifier: Apache-2.0

/** Colours of what a view says of a surface: not seen, occluded, present, seen through. */
export const kEvidenceColors = ["#8b949e", "#3e7bfa", "#30a46c", "#e5484d"] as const;

/** Colours of n points, all the same. */
export function plainColors(count: number, color: string): Uint8Array {
  const rgb = parseColor(color);
  const colors = new Uint8Array(3 * count);
  for (let i = 0; i < colors.length; ++i) colors[i] = rgb[i % 3] ?? 0;
  return colors;
}

/** Red, green and blue of #rrggbb. */
export function parseColor(color: string): [number, number, number] {
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
