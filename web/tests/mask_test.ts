// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { test } from "node:test";
import { PixelMask } from "../src/mask";

const count = (mask: PixelMask) => mask.data.reduce((sum, value) => sum + value, 0);

test("runs give the mask back", () => {
  const runs = [0, 2, 6, 3, 20, 1];
  const mask = new PixelMask(7, 3, runs);
  assert.equal(count(mask), 6);
  assert.deepEqual(mask.toRuns(), runs);
  assert.deepEqual(new PixelMask(7, 3).toRuns(), []);
  assert.deepEqual(new PixelMask(2, 2, [1, 100]).toRuns(), [1, 3], "beyond the image");
});

test("a brush paints what it touches, also at the border", () => {
  const mask = new PixelMask(20, 10);
  mask.paintLine([5, 5], [5, 5], 1, 1);
  assert.deepEqual(mask.toRuns(), [85, 1, 104, 3, 125, 1]);
  mask.paintLine([-3, 0], [30, 0], 0.4, 1);
  assert.equal(count(mask), 5 + 20);
  mask.paintLine([0, 5], [20, 5], 2, 0);
  assert.deepEqual(mask.toRuns(), [0, 20]);
  mask.paintLine([100, 100], [200, 200], 5, 1);
  assert.equal(count(mask), 20);
});

test("a lasso fills what it is drawn around", () => {
  const mask = new PixelMask(20, 10);
  const square = [
    [2, 2],
    [8, 2],
    [8, 6],
    [2, 6],
  ] as const;
  mask.fillPolygon(square, 1);
  assert.equal(count(mask), 7 * 4, "rows 2 to 5: a row belongs to the polygon that begins at it");
  mask.fillPolygon(
    [
      [4, 3],
      [6, 3],
      [6, 5],
      [4, 5],
    ],
    0,
  );
  assert.equal(count(mask), 7 * 4 - 3 * 2);
  const before = mask.toRuns();
  mask.fillPolygon([[3, 3]], 1);
  mask.fillPolygon([], 1);
  assert.deepEqual(mask.toRuns(), before, "a point is no polygon");
  mask.fillPolygon(
    [
      [-50, -50],
      [100, -50],
      [100, 100],
      [-50, 100],
    ],
    1,
  );
  assert.equal(count(mask), 200);
});
