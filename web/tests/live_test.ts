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

test("a run is followed over streams that end or fail, until it is over", async () => {
  const { open, count } = streams([[1, 2], true], [[], true], [[2], false], [[3, 4], false]);
  const seen: number[] = [];
  const onRevision = async (revision: number) => {
    seen.push(revision);
    return revision < 3;
  };
  await follow(open, onRevision, 0);
  assert.deepEqual(seen, [1, 2, 2, 3]);
  assert.equal(count(), 4);
});

test("what goes on failing is given up", async () => {
  const { open, count } = streams([[1], true]);
  await assert.rejects(
    follow(open, async () => true, 0),
    /failure 10/,
  );
  assert.equal(count(), kMaxFailures);
});

test("a revision that could not be shown is asked for again", async () => {
  const { open, count } = streams([[1], false], [[1], false]);
  let isFirst = true;
  await follow(
    open,
    async () => {
      if (!isFirst) return false;
      isFirst = false;
      throw new Error("no answer");
    },
    0,
  );
  assert.equal(count(), 2);
});
