// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import { isDeepStrictEqual } from "node:util";
import { AnnotateKeys, mayRepeat } from "../src/annotate_keys";
import type { AnnotatePanel } from "../src/annotate_panel";
import type { Action, Annotation, Change, Placement, Region, RegionKey } from "../src/annotation";
import { Annotator } from "../src/annotator";
import { type Api, StatusError } from "../src/api";
import { multiply } from "../src/geometry";
import { rotation, translation } from "../src/pose_edit";
import type { Pose, Scene } from "../src/protocol";
import { App } from "../src/store";
import type { World } from "../src/world";

Object.assign(globalThis, { document: { body: { dataset: {} } } });

const kNumViews = 5;
const kScene = {
  objects: [{ name: "cup", center: [0, 0, 0] }],
  views: Array.from({ length: kNumViews }, () => ({ name: "", pose: translation([0, 0, 0]) })),
  runs: [],
} as unknown as Scene;
const placement = (id: number, first_view = 0, last_view = kNumViews - 1): Placement => ({
  id,
  track: id,
  object: 0,
  first_view,
  last_view,
  pose: translation([id, 0, 0]),
});
const kKey: RegionKey = { view: 2, kind: "novel", center: [0, 0, 0] };
const region = (key: RegionKey = kKey): Region => ({
  key,
  ...key,
  num_points: 100,
  pose: translation(key.center),
  size_m: [0.1, 0.1, 0.1],
  verdict: "open",
  track: -1,
  is_corrected: false,
  is_explained: false,
});

/** What the annotator needs of the server. `sent`: titles of actions and names of other requests, in order. */
class FakeServer {
  objects = [placement(0), placement(1)];
  regions = [region()];
  checked_views: number[] = [];
  revision = 0;
  sent: string[] = [];
  changes: Change[] = [];
  /** Thrown by the next requests with this name. */
  failures = new Map<string, Error>();

  async annotation(): Promise<Annotation> {
    await this.receive("annotation");
    const { objects, regions, checked_views, revision } = this;
    const none = { undo: "x", redo: "", events: [], unknown_events: [], to_dos: [] };
    return structuredClone({ objects, regions, checked_views, revision, ...none });
  }
  async act(revision: number, action: Action): Promise<Annotation> {
    await this.receive(typeof action === "string" ? action : action.title);
    if (revision !== this.revision) throw new StatusError(409, "old");
    ++this.revision;
    if (typeof action !== "string") for (const change of action.changes) this.apply(change);
    this.sent.push("-");
    const annotation = await this.annotation();
    this.sent.splice(this.sent.lastIndexOf("-"), 2);
    return annotation;
  }
  async post(what: string, { pose = translation([9, 0, 0]) }: { pose?: Pose }): Promise<unknown> {
    await this.receive(what);
    if (what === "assess") return [];
    return { pose: what === "refine" ? multiply(translation([0, 0, 1]), pose) : pose, views: [], num_pairs: 100 };
  }
  forgetDetails(): void {}

  private async receive(what: string): Promise<void> {
    this.sent.push(what);
    await new Promise((resolve) => setImmediate(resolve));
    const failure = this.failures.get(what);
    if (failure) throw failure;
  }
  private apply(change: Change): void {
    this.changes.push(change);
    const id = change.id as number;
    if (change.do === "drop_object") this.objects = this.objects.filter((each) => each.id !== id);
    if (change.do === "check_view")
      this.checked_views = change.is_checked ? [change.view as number] : this.checked_views.filter(() => false);
    const judged = this.regions.find(({ key }) => isDeepStrictEqual(key, change.region));
    if (change.do === "judge_region") Object.assign(judged ?? {}, change);
    if (change.do !== "put_object") return;
    const put = { ...change, id: id < 0 ? this.objects.length : id } as unknown as Placement;
    if (put.track < 0) put.track = put.id;
    this.objects = [...this.objects.filter((each) => each.id !== put.id), put].sort((a, b) => a.id - b.id);
  }
}

let server: FakeServer;
let app: App;
let annotator: Annotator;
let said: [string, boolean];
beforeEach(async () => {
  server = new FakeServer();
  app = new App(structuredClone(kScene));
  annotator = new Annotator(app, server as unknown as Api, await server.annotation());
  annotator.say = (text, isError = false) => {
    said = [text, isError];
  };
  server.sent = [];
  app.selectTrack(0);
});
const at = (id: number) => server.objects.find((each) => each.id === id);
const right = (pose: Pose) => multiply(translation([1, 0, 0]), pose);

test("an edit keeps what the edits before it have changed, though it was asked for earlier", async () => {
  app.goTo(2);
  annotator.snap();
  annotator.setNumber(0, 0, 5000);
  annotator.applySymmetry(rotation([0, 0, 1], 180));
  annotator.cameHere();
  app.goTo(4);
  annotator.leftHere();
  annotator.joinTrack(0, 7);
  annotator.judge(0, "accepted", annotator.causeOf(0));
  await annotator.correctMask(0, [1, 2]);
  const { pose, ...rest } = at(0) ?? placement(0);
  assert.deepEqual(rest, { ...rest, first_view: 2, last_view: 3, track: 7 });
  assert.deepEqual([pose[0], pose[12], pose[14]].map(Math.round as (value?: number) => number), [-1, 5, 1]);
  assert.equal(server.changes.at(-1)?.verdict, "accepted");
  assert.equal(server.changes.at(-1)?.track, 7);
  assert.deepEqual(at(1), placement(1));
});

test("a region is attributed to the selected object if that is there, in its view or before", async () => {
  server.objects = [placement(0), placement(1), placement(2, 0, 1)];
  const left: RegionKey = { ...kKey, kind: "removed", center: [2, 0, 0] };
  server.regions = [region(), region(left)];
  await annotator.undo();
  const causes = (track: number) => {
    app.selectTrack(track);
    return [annotator.causeOf(0)?.id, annotator.causeOf(1)?.id];
  };
  assert.deepEqual(causes(-1), [undefined, undefined]);
  assert.deepEqual(causes(0), [0, undefined]);
  assert.deepEqual(causes(1), [undefined, undefined], "it is elsewhere");
  assert.deepEqual(causes(2), [undefined, 2], "it had left before the view of the region");
  app.goTo(4); // the view of the region counts, not the one that is shown
  assert.deepEqual(causes(0), [0, undefined]);
  await annotator.judge(0, "accepted", annotator.causeOf(0));
  assert.equal(annotator.nameOfTrack(annotator.annotation.regions[0]?.track ?? -1), "cup");
  assert.equal(annotator.nameOfTrack(-1), "");
});

test("two presses make one event of a thing without model", async () => {
  const left: RegionKey = { ...kKey, kind: "removed", center: [2, 0, 0] };
  const events = () => server.changes.filter((change) => change.do === "put_event").map((change) => change.kind);
  for (const press of [() => annotator.addUnknown(0, "box"), () => annotator.moveUnknown(0, 1, "box")]) {
    server.regions = [region(), region(left)];
    server.changes = [];
    await annotator.undo();
    press();
    await press();
    assert.equal(events().length, 1, events().join());
  }
});

test("a split has the pose of the edit before it; checking twice unchecks", async () => {
  app.goTo(3);
  annotator.setPose(translation([4, 4, 4]));
  await annotator.movedHere();
  const [first, , second] = server.objects;
  assert.deepEqual([first?.last_view, second?.first_view, second?.last_view, second?.track], [2, 3, 4, 0]);
  assert.deepEqual(second?.pose, translation([4, 4, 4]));
  annotator.check();
  await annotator.check();
  assert.deepEqual(server.checked_views, []);
});

test("a placement ends where the views show free space, also between those that were asked about first", async () => {
  const post = server.post.bind(server);
  server.post = async (what, body: { pose?: Pose; first_view?: number; last_view?: number }) => {
    if (what !== "assess") return post(what, body);
    const { first_view = 0, last_view = kNumViews - 1 } = body; // the server tells of both ends
    return [...new Set([first_view, last_view])].map((view) => ({ view, is_gone: view !== 2 }));
  };
  app.goTo(2);
  annotator.placing = 0;
  await annotator.place(1, 1);
  assert.deepEqual(at(2), { ...at(2), first_view: 2, last_view: 2 });
});

test("what cannot be done is said, and nothing is sent", async () => {
  for (const action of [() => annotator.leftHere(), () => annotator.movedHere()]) {
    assert.equal(await action(), false);
    assert.ok(said[1], said[0]);
  }
  await annotator.setNumber(0, 2, Number.NaN);
  assert.deepEqual(said, ["A number is missing.", true]);
  await annotator.setViews(0, { last_view: 1 });
  app.goTo(3);
  assert.equal(await annotator.remove(), false);
  assert.match(said[0], /not in this view/);
  app.goTo(1);
  assert.deepEqual(server.sent, ["Views of cup"]);
  assert.equal(await annotator.remove(), true);
  assert.equal(at(0), undefined);
});

test("moves by keys are one edit of their placement, before anything else", async () => {
  annotator.nudge(right);
  assert.deepEqual(annotator.nudge(right), translation([2, 0, 0]));
  assert.deepEqual(server.sent, []);
  app.selectTrack(1);
  annotator.nudge(right);
  annotator.snap();
  annotator.nudge(right);
  await annotator.undo();
  assert.deepEqual(server.sent, ["Move cup", "Move cup", "refine", "Snap cup", "assess", "Move cup", "undo"]);
  assert.deepEqual(at(0)?.pose, translation([2, 0, 0]));
  assert.deepEqual(at(1)?.pose, translation([3, 0, 1]));
});

test("what was selected when a key was pressed is changed", async () => {
  annotator.snap();
  app.selectTrack(1);
  await annotator.idle();
  assert.deepEqual([at(0)?.pose, at(1)?.pose], [translation([0, 0, 1]), translation([1, 0, 0])]);

  app.goTo(3);
  annotator.movedHere();
  annotator.nudge(right);
  await annotator.idle();
  annotator.nudge(right); // of the second placement, which is there now
  await annotator.check();
  assert.deepEqual([at(1)?.pose, at(2)?.pose], [translation([2, 0, 0]), translation([2, 0, 0])]);
});

test("moves by keys are sent when the keys rest, and when the view changes", async () => {
  annotator.nudge(right);
  annotator.nudge(right);
  await annotator.idle();
  assert.deepEqual(server.sent, []);
  for (let tries = 0; tries < 100 && server.sent.length === 0; ++tries)
    await new Promise((resolve) => setTimeout(resolve, 50));
  await annotator.idle();
  assert.deepEqual(server.sent, ["Move cup"]);
  assert.deepEqual(at(0)?.pose, translation([2, 0, 0]));
  annotator.nudge(right);
  app.goTo(1);
  await annotator.idle();
  assert.deepEqual(at(0)?.pose, translation([3, 0, 0]));
});

test("a failed edit says so, shows what is stored, and does not stop the next one", async () => {
  const { edit } = app.get();
  server.failures.set("Move cup", new Error("lost"));
  assert.equal(await annotator.setPose(translation([5, 5, 5])), false);
  assert.deepEqual(said, ["lost", true]);
  assert.ok(app.get().edit > edit);
  server.failures.clear();
  assert.equal(await annotator.setPose(translation([6, 6, 6])), true);
  assert.deepEqual(said, ["", false], "the error has had its time");
});

test("if the annotation cannot be loaded again, the next edit tries once more", async () => {
  ++server.revision; // by another window
  server.failures.set("annotation", new Error("lost"));
  assert.equal(await annotator.check(), false);
  assert.deepEqual(said, ["lost", true]);
  server.failures.clear();
  assert.equal(await annotator.check(), false);
  assert.match(said[0], /Another window/);
  assert.equal(await annotator.check(), true);
});

test("snap all leaves out what is hardly seen, and stops without a server", async () => {
  const { post } = server;
  let numPairs = 5;
  server.post = async (what, body) => {
    const answer = (await post.call(server, what, body)) as { num_pairs: number };
    const num_pairs = numPairs;
    numPairs = 100;
    return { ...answer, num_pairs };
  };
  await annotator.snapAll();
  assert.match(said[0], /^1 of 2/);
  assert.deepEqual([at(0)?.pose, at(1)?.pose], [translation([0, 0, 0]), translation([1, 0, 1])]);
  server.failures.set("refine", new Error("resight does not answer"));
  assert.equal(await annotator.snapAll(), false);
  assert.deepEqual(said, ["resight does not answer", true]);
});

test("a double click places one object, and a failed click can be repeated", async () => {
  annotator.placing = 0;
  const click = annotator.place(1, 1);
  assert.equal(await annotator.place(1, 1), false);
  assert.equal(await click, true);
  assert.equal(server.objects.length, 3);
  assert.equal(app.get().track, 2);
  annotator.placing = 0;
  server.failures.set("place", new Error("there is no depth at this pixel"));
  assert.equal(await annotator.place(1, 1), false);
  assert.equal(annotator.placing, 0);
  assert.deepEqual(said, ["there is no depth at this pixel", true]);
});

test("keys that are held repeat moves and steps through views only", () => {
  for (const key of ["ArrowLeft", "PageUp", ",", "<", "n"]) assert.ok(mayRepeat(key), key);
  for (const key of ["Delete", "v", "z", "s", "Tab", " ", "Enter", "ns"]) assert.ok(!mayRepeat(key), key);
});

test("a move key draws the object where it will be", () => {
  const drawn: Pose[] = [];
  const world = { gizmo: () => ({ onDrag: (pose: Pose) => drawn.push(pose) }) } as unknown as World;
  const panel = { gizmo: { axes: "world" } } as unknown as AnnotatePanel;
  const keys = new AnnotateKeys(annotator, panel, world);
  const press = (key: string, ctrlKey = false) => keys.actionOf({ key, ctrlKey, shiftKey: true } as KeyboardEvent)?.();
  press("ArrowRight");
  press("ArrowDown", true);
  assert.deepEqual(drawn, [translation([0.001, 0, 0]), translation([0.001, 0.01, 0])]);
  app.selectNothing(); // sends it, so that no timer holds the test
});
