// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import test from "node:test";
import { formatLink, kDefaultState, type LinkState, parseLink } from "../src/link";

const kCounts = { views: 10, runs: 2, objects: 5 };

test("a link restores what it was made from", () => {
  const state: LinkState = {
    view: 7,
    run: 1,
    compare: 0,
    track: 12,
    object: -1,
    layers: new Set(["cloud", "truth"]),
    objectColors: "evidence",
    cloudColors: "distance",
    camera: { position: [1.25, -2, 3e-3], target: [0, 0, 1] },
  };
  const { token, state: restored } = parseLink(formatLink(state, "secret"), kCounts);
  assert.equal(token, "secret");
  assert.deepEqual(restored, state);
});

test("what is as by default is left out", () => {
  assert.equal(formatLink(kDefaultState, "t"), "#token=t");
  assert.deepEqual(parseLink("#token=t", kCounts).state, kDefaultState);
  assert.equal(parseLink("#layers=", kCounts).state.layers.size, 0, "no layers is not the default");
});

test("what does not fit takes its default", () => {
  for (const fragment of [
    "#view=10&run=2&compare=9",
    "#view=-1&run=x&track=1.5&object=5",
    "#view=1e3&camera=1_2_x_4_5_6",
  ])
    assert.deepEqual(parseLink(fragment, kCounts).state, kDefaultState, fragment);
  assert.deepEqual(parseLink("#objects=none&points=&layers=cloud.nothing", kCounts).state, {
    ...kDefaultState,
    layers: new Set(["cloud"]),
  });
});
