// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import test from "node:test";
import { follow, kMaxFailures } from "../src/live";

/** Streams, one per attempt to connect: revisions, and whether it fails after them. */
function streams(...planned: [number[], boolean][]) {
  let count = 0;
  const open = async function* () {
    const [revisions, isBroken] = planned[count++] ?? [[], true];
    yield* revisions;
    if (isBroken) throw new Error(`failure ${count}`);
  };
  return { open, count: () => count };
}

/** A page that shows `revision`, of a run that is over with the last one. */
function page(revision: number, lastRevision: number) {
  const loaded: number[] = [];
  const shown = {
    revision: () => revision,
    isLive: () => revision < lastRevision,
    reload: async () => {
      ++revision;
      loaded.push(revision);
    },
  };
  return { shown, loaded };
}

test("a run is followed over streams that end or fail, until it is over", async () => {
  const { open, count } = streams([[1, 2], true], [[], true], [[2], false], [[3, 4], false]);
  const { shown, loaded } = page(0, 3);
  await follow(open, shown, 0);
  assert.deepEqual(loaded, [1, 2, 3]);
  assert.equal(count(), 4);
});

test("revisions that waited while a newer one was loaded are passed over", async () => {
  const { open, count } = streams([[3, 4, 5], false], [[6], false]);
  const { shown, loaded } = page(5, 6);
  await follow(open, shown, 0);
  assert.deepEqual(loaded, [6]);
  assert.equal(count(), 2);
});

test("what goes on failing is given up", async () => {
  const { open, count } = streams([[1], true]);
  await assert.rejects(follow(open, page(0, 9).shown, 0), /failure 10/);
  assert.equal(count(), kMaxFailures);
});

test("a revision that could not be shown is asked for again", async () => {
  const { open, count } = streams([[1], false], [[1], false]);
  const { shown, loaded } = page(0, 1);
  let isFirst = true;
  const reload = async () => {
    if (!isFirst) return shown.reload();
    isFirst = false;
    throw new Error("no answer");
  };
  await follow(open, { ...shown, reload }, 0);
  assert.equal(count(), 2);
  assert.deepEqual(loaded, [1]);
});
