// SPDX-License-Identifier: Apache-2.0
// A mask of an image that is painted on. Runs: index of the first pixel and number of pixels in turn. No page needed.

export type Point = readonly [number, number];

export class PixelMask {
  /** 1 where the mask is; row by row. */
  readonly data: Uint8Array;

  constructor(
    readonly width: number,
    readonly height: number,
    runs: readonly number[] = [],
  ) {
    this.data = new Uint8Array(width * height);
    for (let i = 0; i + 1 < runs.length; i += 2) {
      const first = runs[i] ?? 0;
      this.data.fill(1, first, first + (runs[i + 1] ?? 0));
    }
  }

  toRuns(): number[] {
    const runs: number[] = [];
    let end = -1;
    this.data.forEach((value, pixel) => {
      if (value === 0) return;
      if (pixel === end) runs[runs.length - 1] = (runs.at(-1) ?? 0) + 1;
      else runs.push(pixel, 1);
      end = pixel + 1;
    });
    return runs;
  }

  /** Paints all pixels within `radius` of a line. Positions are pixels; their centres are whole numbers. */
  paintLine(from: Point, to: Point, radius: number, value: 0 | 1): void {
    const [dx, dy] = [to[0] - from[0], to[1] - from[1]];
    const squared = dx * dx + dy * dy;
    const box = this.clip(
      Math.min(from[0], to[0]) - radius,
      Math.min(from[1], to[1]) - radius,
      Math.max(from[0], to[0]) + radius,
      Math.max(from[1], to[1]) + radius,
    );
    for (let v = box.top; v <= box.bottom; ++v)
      for (let u = box.left; u <= box.right; ++u) {
        const along = squared > 0 ? ((u - from[0]) * dx + (v - from[1]) * dy) / squared : 0;
        const t = Math.max(0, Math.min(1, along));
        if (Math.hypot(u - from[0] - t * dx, v - from[1] - t * dy) <= radius) this.data[v * this.width + u] = value;
      }
  }

  /** Paints the pixels whose centres lie in a polygon, which closes itself. */
  fillPolygon(points: readonly Point[], value: 0 | 1): void {
    const rows = points.map((point) => point[1]);
    const { top, bottom } = this.clip(0, Math.min(...rows), 0, Math.max(...rows));
    for (let v = top; v <= bottom; ++v) {
      const crossings = findCrossings(points, v);
      for (let i = 0; i + 1 < crossings.length; i += 2) {
        const left = Math.max(0, Math.ceil(crossings[i] ?? 0));
        const right = Math.min(this.width - 1, Math.floor(crossings[i + 1] ?? 0));
        if (left <= right) this.data.fill(value, v * this.width + left, v * this.width + right + 1);
      }
    }
  }

  private clip(left: number, top: number, right: number, bottom: number) {
    return {
      left: Math.max(0, Math.ceil(left)),
      top: Math.max(0, Math.ceil(top)),
      right: Math.min(this.width - 1, Math.floor(right)),
      bottom: Math.min(this.height - 1, Math.floor(bottom)),
    };
  }
}

/** Where the edges of a polygon cross a row, ascending. */
function findCrossings(points: readonly Point[], v: number): number[] {
  const crossings: number[] = [];
  points.forEach((a, i) => {
    const b = points[(i + 1) % points.length] ?? a;
    if (a[1] <= v === b[1] <= v) return;
    crossings.push(a[0] + ((v - a[1]) / (b[1] - a[1])) * (b[0] - a[0]));
  });
  return crossings.sort((x, y) => x - y);
}
