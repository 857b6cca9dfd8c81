// SPDX-License-Identifier: Apache-2.0
// How fast the points of a view turn, for documentation: prints it and expects only that something is drawn.
import assert from "node:assert/strict";
import { test } from "node:test";
import type { Page } from "playwright-core";
import { open, serve, setting, waitForDrawing, waitForView } from "./page";

const kSteps = 200;

interface Drawn {
  frames: number;
  points: number;
}
declare global {
  interface Window {
    drawn: Drawn;
  }
}

/** Counts frames in which points are drawn, and these points. */
function countFrames(page: Page): Promise<void> {
  return page.evaluate(() => {
    window.drawn = { frames: 0, points: 0 };
    let points = 0;
    const prototype = WebGL2RenderingContext.prototype;
    const draw = prototype.drawArrays;
    prototype.drawArrays = function (mode, first, count) {
      if (mode === this.POINTS) points += count;
      draw.call(this, mode, first, count);
    };
    const next = () => {
      if (points > 0) ++window.drawn.frames;
      window.drawn.points += points;
      points = 0;
      requestAnimationFrame(next);
    };
    requestAnimationFrame(next);
  });
}

test("points turn", async (t) => {
  const server = await serve([setting("SEQUENCE")]);
  const page = await open(server.address);
  await waitForView(page, 0);
  await waitForDrawing(page, 10);
  await countFrames(page);
  const box = await page.locator("#world canvas").boundingBox();
  assert.ok(box);
  const [x, y] = [box.x + box.width / 3, box.y + box.height / 2];
  await page.mouse.move(x, y);
  await page.mouse.down();
  const start = performance.now();
  for (let i = 0; i < kSteps; ++i) {
    await page.mouse.move(x + i, y + i / 3);
    await page.waitForTimeout(16);
  }
  const { frames, points } = await page.evaluate(() => window.drawn);
  const seconds = (performance.now() - start) / 1000;
  await page.mouse.up();
  t.diagnostic(
    `${(frames / seconds).toFixed(0)} frames a second of ${Math.round(points / Math.max(frames, 1))} points`,
  );
  assert.ok(frames > 0 && points > 0, "nothing was drawn");
  await server.stop();
});
