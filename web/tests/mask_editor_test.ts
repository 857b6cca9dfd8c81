// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import type { Annotator } from "../src/annotator";
import type { Api } from "../src/api";
import type { ImagePanel, PointerTool } from "../src/image_panel";
import { PixelMask, type Point } from "../src/mask";
import { MaskEditor } from "../src/mask_editor";
import type { Scene } from "../src/protocol";
import { App } from "../src/store";

const canvas = { setAttribute: () => {}, append: () => {}, getContext: () => null };
Object.assign(globalThis, { document: { createElement: () => canvas } });

const kWidth = 100;
const kHeight = 100;
/** Resolves what is waited for, and lets all that follows happen. */
const settle = () => new Promise((resolve) => setImmediate(resolve));

let app: App;
let tool: PointerTool;
let editor: MaskEditor;
/** Masks of the server; strokes that were sent, and what answers them; masks that were asked for, likewise. */
let stored: number[][];
let strokes: { region: number; runs: number[]; answer: () => void }[];
let loads: (() => void)[];

beforeEach(() => {
  app = new App({ views: [{}, {}], runs: [], objects: [] } as unknown as Scene);
  stored = [
    [0, 1],
    [99, 1],
  ];
  strokes = [];
  loads = [];
  const panel = { draw: () => {}, tool: null } as unknown as ImagePanel;
  const api = {
    view: async () => ({ camera: { width: kWidth, height: kHeight } }),
    regionPixels: (region: number) => {
      const pixels = { proposed: stored[region], corrected: null };
      return new Promise((resolve) => loads.push(() => resolve(pixels)));
    },
  };
  const annotator = {
    app,
    annotation: { regions: [{ view: 0 }, { view: 0 }] },
    say: assert.fail,
    correctMask: (region: number, runs: number[]) =>
      new Promise<boolean>((resolve) => {
        const answer = () => {
          stored[region] = runs;
          app.set({ edit: app.get().edit + 1 });
          resolve(true);
        };
        strokes.push({ region, runs, answer });
      }),
  };
  editor = new MaskEditor(annotator as unknown as Annotator, api as unknown as Api, panel);
  editor.begin(0);
  assert.ok(panel.tool);
  tool = panel.tool;
});
async function answerLoads(): Promise<void> {
  for (const load of loads.splice(0)) load();
  await settle();
}
function stroke(at: Point): void {
  tool.press(at);
  tool.release();
}
/** Whether the mask that was sent has a pixel. */
const has = (runs: number[], [u, v]: Point) => new PixelMask(kWidth, kHeight, runs).data[v * kWidth + u] === 1;

test("the answer to a stroke does not replace a newer one", async () => {
  await answerLoads();
  stroke([20, 20]);
  stroke([50, 50]);
  strokes[0]?.answer();
  await settle();
  await answerLoads();
  stroke([80, 80]);
  const runs = strokes[2]?.runs ?? [];
  assert.ok(has(runs, [20, 20]) && has(runs, [50, 50]) && has(runs, [80, 80]) && has(runs, [0, 0]));
});

test("what is being painted when an answer comes stays", async () => {
  await answerLoads();
  stroke([20, 20]);
  tool.press([50, 50]);
  strokes[0]?.answer();
  await settle();
  await answerLoads();
  tool.drag([60, 50]);
  tool.release();
  const runs = strokes[1]?.runs ?? [];
  assert.ok(has(runs, [20, 20]) && has(runs, [50, 50]) && has(runs, [60, 50]));
});

test("a mask that comes while a stroke is painted does not replace it", async () => {
  await answerLoads();
  app.set({ edit: 1 });
  tool.press([20, 20]);
  tool.drag([40, 20]);
  await answerLoads();
  tool.drag([60, 20]);
  tool.release();
  const { runs = [] } = strokes[0] ?? {};
  assert.ok(has(runs, [20, 20]) && has(runs, [60, 20]));
});

test("of two masks that are loading, the newer one counts", async () => {
  await answerLoads();
  app.set({ edit: 1 });
  stored[0] = [500, 1];
  app.set({ edit: 2 });
  for (const load of [...loads].reverse()) {
    load();
    await settle();
  }
  stroke([50, 50]);
  const { runs = [] } = strokes[0] ?? {};
  assert.ok(has(runs, [0, 5]) && !has(runs, [0, 0]));
});

test("once all strokes are stored, the mask is that of the server", async () => {
  await answerLoads();
  stroke([20, 20]);
  strokes[0]?.answer();
  stored[0] = [500, 1]; // undone, say
  await settle();
  await answerLoads();
  stroke([50, 50]);
  const runs = strokes[1]?.runs ?? [];
  assert.ok(has(runs, [0, 5]) && has(runs, [50, 50]) && !has(runs, [20, 20]));
});

test("a stroke belongs to the region that is edited, also while its mask is loading", async () => {
  await answerLoads();
  stroke([20, 20]);
  editor.begin(1);
  stroke([50, 50]);
  assert.equal(strokes.length, 1, "there is no mask to paint on yet");
  strokes[0]?.answer();
  await settle();
  await answerLoads();
  stroke([70, 70]);
  const { region, runs = [] } = strokes[1] ?? {};
  assert.equal(region, 1);
  assert.ok(has(runs, [99, 0]) && has(runs, [70, 70]) && !has(runs, [20, 20]) && !has(runs, [50, 50]));
});
