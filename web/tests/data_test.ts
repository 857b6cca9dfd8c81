// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import test from "node:test";
import { Api, inOrder, numKeptViews, Recent, splitEvents } from "../src/api";
import { distanceColors, kEvidenceColors, parseColor, plainColors } from "../src/colors";
import { decodeCloud } from "../src/protocol";

function encode(count: number, flags: number, size: number): ArrayBuffer {
  const bytes = new ArrayBuffer(size);
  new Uint32Array(bytes, 0, 2).set([count, flags]);
  return bytes;
}

test("clouds are decoded by their flags", () => {
  assert.equal(decodeCloud(encode(4, 0, 8 + 48)).positions.length, 12);
  const whole = decodeCloud(encode(4, 3, 8 + 48 + 12 + 12));
  assert.equal(whole.normals?.length, 12);
  assert.equal(whole.colors?.length, 12);
  assert.equal(decodeCloud(encode(4, 2, 8 + 48 + 12)).normals, null);
});

test("clouds that are cut off are refused", () => {
  assert.throws(() => decodeCloud(new ArrayBuffer(4)));
  assert.throws(() => decodeCloud(encode(4, 1, 8 + 48)));
  assert.throws(() => decodeCloud(encode(1 << 30, 0, 8 + 48)));
});

test("what was used last is kept, and made once", async () => {
  const dropped: string[] = [];
  const recent = new Recent<string>(2, (value) => dropped.push(value));
  let made = 0;
  const make = (value: string) => async () => {
    ++made;
    return value;
  };
  await recent.get("a", make("A"));
  await recent.get("b", make("B"));
  await recent.get("a", make("A"));
  await recent.get("c", make("C"));
  assert.equal(made, 3);
  await Promise.resolve();
  assert.deepEqual(dropped, ["B"]);
});

test("what failed is tried again", async () => {
  const recent = new Recent<number>(2);
  await assert.rejects(recent.get("a", () => Promise.reject(new Error("no"))));
  assert.equal(await recent.get("a", async () => 3), 3);
});

test("colours are bytes", () => {
  assert.deepEqual(parseColor("#ff8001"), [255, 128, 1]);
  assert.deepEqual([...plainColors(2, "#010203")], [1, 2, 3, 1, 2, 3]);
  const [near, far, beyond] = [0, 3, 6].map((i) => distanceColors(new Float32Array([1, 2, 9]), 1, 2).slice(i, i + 3));
  assert.notDeepEqual(near, far);
  assert.deepEqual(far, beyond);
});

test("events are split where they are whole", () => {
  assert.deepEqual(splitEvents("data: 1\n\n:\n\ndata: 2\n\ndata: 3"), { data: ["1", "2"], rest: "data: 3" });
  assert.deepEqual(splitEvents(""), { data: [], rest: "" });
});

test("so many views are kept as fit into the memory", () => {
  const kept = (width: number, height: number) => numKeptViews({ width, height, fx: 1, fy: 1, cx: 0, cy: 0 });
  assert.equal(kept(640, 480), 24);
  assert.equal(kept(1920, 1080), 10);
  assert.equal(kept(6000, 4000), 3);
});

test("placements get their own outlines, whatever another window has done", () => {
  const placement = (id: number) => ({ id, track: 0, object: 0, first_view: 0, last_view: 0, pose: [] });
  const details = (id: number) => ({ id, outline: [[id]], covariance: null, evidence: [] });
  const found = inOrder([placement(1), placement(2), placement(4)], [details(4), details(0), details(1)]);
  assert.deepEqual(
    found.map((each) => each.outline),
    [[[1]], [], [[4]]],
  );
});

test("a stream that has failed throws its own error", async (context) => {
  const reader = {
    read: () => Promise.reject(new Error("cut off")),
    cancel: () => Promise.reject(new Error("cannot cancel")),
  };
  context.mock.method(globalThis, "fetch", async () => ({ ok: true, body: { getReader: () => reader } }));
  await assert.rejects(new Api("").revisions().next(), /cut off/);
});

test("present and seen through differ in brightness, not in hue alone", () => {
  const luminance = (color: string) => {
    const linear = parseColor(color).map((value) => (value / 255) ** 2.2);
    return 0.2126 * (linear[0] ?? 0) + 0.7152 * (linear[1] ?? 0) + 0.0722 * (linear[2] ?? 0);
  };
  const [, , present, seenThrough] = kEvidenceColors;
  assert.ok((luminance(present) + 0.05) / (luminance(seenThrough) + 0.05) > 3);
});
