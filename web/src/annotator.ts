// SPDX-License-Identifier: Apache-2.0
// Edits of the annotation: sends them to the server and shows its answer.
import {
  type Action,
  type Annotation,
  beginAt,
  type Change,
  endBefore,
  isIn,
  type Placement,
  placementAt,
  placementBeside,
  presentInterval,
  putObject,
  type Region,
  type RegionKey,
  splitAt,
  toRun,
  unknownEnds,
  type ViewResidual,
} from "./annotation";
import { type Api, StatusError } from "./api";
import { distanceToBox, multiply, transformPoint } from "./geometry";
import { withNumber } from "./pose_edit";
import type { Pose } from "./protocol";
import type { App } from "./store";

/** Regions this near to an object may belong to it. */
const kNearM = 0.02;
/** After so long without another one, moves by keys are sent. */
const kNudgePauseMs = 350;
const kMinPairs = 30;

/** The views do not show enough of an object to fit it: no fault of the program. */
class TooLittleSeen extends Error {
  constructor() {
    super("No view shows enough of the object here. Move it nearer first.");
  }
}

const acceptUnknown = (region: RegionKey): Change => ({ do: "judge_region", region, verdict: "accepted", track: -1 });
const messageOf = (error: unknown): string => (error instanceof Error ? error.message : String(error));

export class Annotator {
  annotation: Annotation;
  /** Residuals of the selected object per view, of the pose `residualsOf`. */
  residuals: ViewResidual[] = [];
  residualsOf: Pose | null = null;
  /** Model that the next click places; -1: none. */
  placing = -1;
  /** Moves by keys of one placement that are not sent yet. */
  private nudged: { id: number; by: (pose: Pose) => Pose } | null = null;
  private nudgeTimer: ReturnType<typeof setTimeout> | undefined;
  private queue: Promise<unknown> = Promise.resolve();
  onChange: () => void = () => {};
  say: (text: string, isError?: boolean) => void = () => {};

  constructor(
    readonly app: App,
    private readonly api: Api,
    annotation: Annotation,
  ) {
    this.annotation = annotation;
    app.listen((changed) => {
      if (changed.has("track") || changed.has("view")) this.flush();
    });
  }

  selected(): Placement | null {
    const { track, view } = this.app.get();
    return track < 0 ? null : placementAt(this.annotation, track, view);
  }

  /** Runs jobs one after the other, so that each is based on the answer to the last one. Resolves to whether the job
   * succeeded; never rejects. */
  private run(job: () => Promise<void>): Promise<boolean> {
    this.flush();
    this.say(""); // what the last step said, also if it failed
    return this.enqueue(job);
  }
  private enqueue(job: () => Promise<void>): Promise<boolean> {
    const next = this.queue.then(async () => {
      document.body.dataset.busy = "yes";
      try {
        await job();
        return true;
      } catch (error) {
        await this.onFailure(error);
        return false;
      } finally {
        delete document.body.dataset.busy;
      }
    });
    this.queue = next;
    return next;
  }
  /** Resolves when all that was asked for until now is done. */
  idle(): Promise<unknown> {
    return this.queue;
  }
  private async onFailure(error: unknown): Promise<void> {
    const isOutdated = error instanceof StatusError && error.status === 409;
    const text = isOutdated ? await this.loadAgain() : messageOf(error);
    this.redraw(); // what was dragged goes back to where it is stored
    this.say(text, true);
  }
  private async loadAgain(): Promise<string> {
    try {
      this.show(await this.api.annotation());
    } catch (error) {
      return messageOf(error);
    }
    return "Another window has changed the annotation. It is loaded again; please repeat your last step.";
  }

  private show(annotation: Annotation): void {
    this.annotation = annotation;
    this.app.scene.runs = [
      toRun(
        annotation,
        this.app.scene.views.map((view) => view.pose),
      ),
    ];
    this.api.forgetDetails();
    this.redraw();
    document.body.dataset.revision = String(annotation.revision);
    this.onChange();
  }
  private redraw(): void {
    this.app.set({ edit: this.app.get().edit + 1 });
  }
  private async send(action: Action): Promise<void> {
    this.show(await this.api.act(this.annotation.revision, action));
  }

  private edit(title: string, changes: Change[]): Promise<boolean> {
    return this.run(() => this.send({ title, changes }));
  }
  /** Changes a placement as it is when the job runs: edits before it may have changed what is selected now. */
  private change(title: string, make: (now: Placement) => Placement[], id = this.selected()?.id): Promise<boolean> {
    return id === undefined ? Promise.resolve(false) : this.run(() => this.sendChange(title, make, id));
  }
  private async sendChange(title: string, make: (now: Placement) => Placement[], id: number): Promise<void> {
    const now = this.find(id);
    await this.send({ title: `${title} ${this.nameOf(now.object)}`, changes: make(now).map(putObject) });
  }
  private find(id: number): Placement {
    const found = this.annotation.objects.find((each) => each.id === id);
    if (!found) throw new Error("The placement is no longer there.");
    return found;
  }
  /** Like change(), for a region. */
  private changeRegion(title: string, region: number, make: (now: Region) => Change[]): Promise<boolean> {
    return this.run(async () => {
      const now = this.annotation.regions[region];
      if (now) await this.send({ title, changes: make(now) });
    });
  }
  undo(): Promise<boolean> {
    return this.run(async () => {
      const { undo } = this.annotation;
      if (!undo) return;
      await this.send("undo");
      this.say(`Undone: ${undo}`);
    });
  }
  redo(): Promise<boolean> {
    return this.run(async () => {
      const { redo } = this.annotation;
      if (!redo) return;
      await this.send("redo");
      this.say(`Done again: ${redo}`);
    });
  }

  /** Places the chosen model at a pixel of the current view, and fits it to all views in which it is there. */
  place(u: number, v: number): Promise<boolean> {
    const object = this.placing;
    if (object < 0) return Promise.resolve(false);
    const { view } = this.app.get();
    this.setPlacing(-1); // the second click of a double click places nothing
    return this.run(async () => {
      this.say("Placing …");
      try {
        await this.findPlace(object, view, u, v);
      } catch (error) {
        if (this.placing < 0) this.setPlacing(object);
        throw error;
      }
      const added = this.annotation.objects.reduce<Placement | null>(
        (latest, each) => (latest && latest.id > each.id ? latest : each),
        null,
      );
      if (!added) return;
      this.app.selectTrack(added.track);
      await this.assess();
      this.say(`${this.nameOf(object)} is in views ${added.first_view + 1} to ${added.last_view + 1}.`);
    });
  }
  private setPlacing(object: number): void {
    this.placing = object;
    this.onChange();
  }
  private async findPlace(object: number, view: number, u: number, v: number): Promise<void> {
    const { pose } = await this.api.post<{ pose: Pose }>("place", { object, view, u, v });
    const [first_view, last_view] = await this.findInterval(object, pose, view);
    const refined = await this.refinePose(object, pose, first_view, last_view, true);
    await this.send({
      title: `Place ${this.nameOf(object)}`,
      changes: [putObject({ object, first_view, last_view, pose: refined })],
    });
  }
  /** The views around `view` in which the object may be. The server tells of some views of a long sequence, and then of
   * those where the interval may end. */
  private async findInterval(object: number, pose: Pose, view: number): Promise<[number, number]> {
    const numViews = this.app.scene.views.length;
    const found = await this.api.post<ViewResidual[]>("assess", { object, pose });
    for (let ends = unknownEnds(found, view, numViews); ends.length > 0; ends = unknownEnds(found, view, numViews))
      for (const [first_view, last_view] of ends)
        found.push(...(await this.api.post<ViewResidual[]>("assess", { object, pose, first_view, last_view })));
    return presentInterval(found, view, numViews);
  }

  setPose(pose: Pose, title = "Move", id = this.selected()?.id): Promise<boolean> {
    return this.change(title, (now) => [{ ...now, pose }], id);
  }
  /** Sets one of the six numbers of a pose. */
  setNumber(id: number, index: number, value: number): Promise<boolean> {
    const make = (now: Placement): Placement[] => {
      const pose = withNumber(now.pose, this.app.object(now.object)?.center ?? [0, 0, 0], index, value);
      if (!pose) throw new Error("A number is missing.");
      return [{ ...now, pose }];
    };
    return this.change(index < 3 ? "Move" : "Turn", make, id);
  }
  /** Moves the selected object by a key. It is sent when the keys rest, or before anything else, as one edit. Returns
   * where it shall be drawn until then. */
  nudge(by: (pose: Pose) => Pose): Pose | null {
    const placement = this.selected();
    if (!placement) return null;
    if (this.nudged?.id !== placement.id) this.flush();
    this.say("");
    const before = this.nudged?.by;
    const all = before ? (pose: Pose) => by(before(pose)) : by;
    this.nudged = { id: placement.id, by: all };
    clearTimeout(this.nudgeTimer);
    this.nudgeTimer = setTimeout(() => this.flush(), kNudgePauseMs);
    return all(placement.pose);
  }
  /** Sends what keys have moved. */
  private flush(): void {
    const { nudged } = this;
    if (!nudged) return;
    clearTimeout(this.nudgeTimer);
    this.nudged = null;
    this.enqueue(() => this.sendChange("Move", (now) => [{ ...now, pose: nudged.by(now.pose) }], nudged.id));
  }

  /** `all_turns`: also chooses between poses of the same shape by their colours. */
  private async refinePose(
    object: number,
    pose: Pose,
    first_view: number,
    last_view: number,
    all_turns = false,
  ): Promise<Pose> {
    const answer = await this.api.post<{ pose: Pose; views: ViewResidual[]; num_pairs: number }>("refine", {
      object,
      pose,
      first_view,
      last_view,
      all_turns,
    });
    if (answer.num_pairs < kMinPairs) throw new TooLittleSeen();
    return answer.pose;
  }

  /** Fits the selected object to all views of its placement. */
  snap(): Promise<boolean> {
    const id = this.selected()?.id;
    if (id === undefined) return Promise.resolve(false);
    return this.run(async () => {
      const now = this.find(id);
      const pose = await this.refinePose(now.object, now.pose, now.first_view, now.last_view);
      await this.send({ title: `Snap ${this.nameOf(now.object)}`, changes: [putObject({ ...now, pose })] });
      await this.assess();
    });
  }
  /** Fits all objects, in one edit. */
  snapAll(): Promise<boolean> {
    return this.run(async () => {
      const changes: Change[] = [];
      for (const placement of this.annotation.objects) {
        this.say(`Snapping ${changes.length + 1} of ${this.annotation.objects.length} …`);
        const { object, first_view, last_view } = placement;
        try {
          changes.push(
            putObject({ ...placement, pose: await this.refinePose(object, placement.pose, first_view, last_view) }),
          );
        } catch (error) {
          if (!(error instanceof TooLittleSeen)) throw error;
        }
      }
      if (changes.length > 0) await this.send({ title: "Snap all", changes });
      this.say(`${changes.length} of ${this.annotation.objects.length} objects fit the views.`);
    });
  }
  /** What each view says of the selected object. */
  private async assess(): Promise<void> {
    const placement = this.selected();
    if (!placement) return;
    this.residuals = await this.api.post<ViewResidual[]>("assess", { object: placement.object, pose: placement.pose });
    this.residualsOf = placement.pose;
    this.onChange();
  }
  showResiduals(): Promise<boolean> {
    return this.run(() => this.assess());
  }

  /** Takes the equivalent pose under a symmetry motion. */
  applySymmetry(motion: Pose): Promise<boolean> {
    return this.change("Turn by symmetry", (now) => [{ ...now, pose: multiply(now.pose, motion) }]);
  }

  setViews(id: number, views: Partial<Pick<Placement, "first_view" | "last_view">>): Promise<boolean> {
    return this.change("Views of", (now) => [{ ...now, ...views }], id);
  }
  /** The selected object came before the current view, or came back if it had left. */
  cameHere(): Promise<boolean> {
    const { view } = this.app.get();
    const numViews = this.app.scene.views.length;
    return this.change("Views of", (now) => [beginAt(now, view, this.annotation.objects, numViews)]);
  }
  /** It left before the current view. */
  leftHere(): Promise<boolean> {
    const { view } = this.app.get();
    return this.change("Views of", (now) => [endBefore(now, view)]);
  }
  /** It moved before the current view: its placement ends, and another one begins, to be moved. */
  movedHere(): Promise<boolean> {
    const { view } = this.app.get();
    return this.change("Split", (now) => splitAt(now, view));
  }
  /** A placement goes on as that of another track of the same model, or apart from it. */
  async joinTrack(id: number, track: number): Promise<void> {
    const isDone = await this.change("Track of", (now) => [{ ...now, track }], id);
    if (isDone) this.app.selectTrack(this.find(id).track);
  }
  remove(): Promise<boolean> {
    const placement = this.selected();
    if (!placement) return Promise.resolve(false);
    const { id, object } = placement;
    const name = this.nameOf(object);
    if (!isIn(placement, this.app.get().view)) {
      this.say(`${name} is not in this view. Go to a view that shows what you want to delete.`, true);
      return Promise.resolve(false);
    }
    return this.edit(`Delete ${name}`, [{ do: "drop_object", id }]);
  }

  /** The placement of the selected track that may have caused a region; null if there is none. */
  causeOf(region: number): Placement | null {
    const found = this.annotation.regions[region];
    const { track } = this.app.get();
    if (!found || track < 0) return null;
    const placement = placementBeside(this.annotation, track, found);
    const object = this.app.object(placement?.object ?? -1);
    if (!placement || !object) return null;
    const radius = 0.5 * (object.diameter_m ?? 0) + kNearM;
    const center = transformPoint(placement.pose, object.center ?? [0, 0, 0]);
    return distanceToBox(center, found.pose, found.size_m) <= radius ? placement : null;
  }
  /** `cause`: the placement that explains the region. */
  judge(region: number, verdict: "open" | "accepted" | "rejected", cause: Placement | null = null): Promise<boolean> {
    return this.changeRegion(`Region ${verdict}`, region, ({ key }) => {
      const track = cause ? this.find(cause.id).track : -1;
      return [{ do: "judge_region", region: key, verdict, track }];
    });
  }
  /** Drops a decision about a region that is no longer proposed. */
  forget(region: RegionKey): Promise<boolean> {
    return this.edit("Forget a region", [{ do: "judge_region", region, verdict: "open", track: -1, mask: null }]);
  }
  /** `runs`: null takes the mask that was proposed. */
  correctMask(region: number, runs: number[] | null): Promise<boolean> {
    return this.changeRegion("Mask", region, ({ key, verdict, track }) => [
      { do: "judge_region", region: key, verdict, track, mask: runs },
    ]);
  }
  /** An event of a thing without model where a region came or left. */
  addUnknown(region: number, name: string): Promise<boolean> {
    return this.run(async () => {
      const key = this.openRegion(region);
      if (!key) return;
      const isNovel = key.kind === "novel";
      const event = {
        do: "put_event",
        view: key.view,
        kind: isNovel ? "added" : "removed",
        name,
        before: isNovel ? null : key.center,
        after: isNovel ? key.center : null,
      };
      await this.send({ title: `Unknown thing ${isNovel ? "came" : "left"}`, changes: [event, acceptUnknown(key)] });
    });
  }
  /** Null if it was decided meanwhile, as by a second press of the same button. */
  private openRegion(region: number): RegionKey | null {
    const found = this.annotation.regions[region];
    return found?.verdict === "open" ? found.key : null;
  }
  /** A thing without model moved from one region to the other, before the earlier of their views. */
  moveUnknown(one: number, other: number, name: string): Promise<boolean> {
    return this.run(async () => {
      const found = [this.openRegion(one), this.openRegion(other)];
      const from = found.find((key) => key?.kind === "removed");
      const to = found.find((key) => key?.kind === "novel");
      if (!from || !to) return;
      const view = Math.min(from.view, to.view);
      const event = { do: "put_event", view, kind: "moved", name, before: from.center, after: to.center };
      await this.send({ title: "Unknown thing moved", changes: [event, acceptUnknown(from), acceptUnknown(to)] });
    });
  }
  dropEvent(id: number): Promise<boolean> {
    return this.edit("Delete event", [{ do: "drop_event", id }]);
  }
  /** Marks the current view as checked, or takes that back. */
  check(): Promise<boolean> {
    const { view } = this.app.get();
    return this.run(() => {
      const is_checked = !this.annotation.checked_views.includes(view);
      const title = `${is_checked ? "Check" : "Uncheck"} view ${view + 1}`;
      return this.send({ title, changes: [{ do: "check_view", view, is_checked }] });
    });
  }
  export(): Promise<boolean> {
    return this.run(async () => {
      this.say("Exporting …");
      const { folder } = await this.api.post<{ folder: string }>("export", {});
      this.say(`Exported to ${folder}`);
    });
  }

  /** Name of the model of a track; empty if there is no such track. */
  nameOfTrack(track: number): string {
    const found = this.annotation.objects.find((each) => each.track === track);
    return found ? this.nameOf(found.object) : "";
  }
  nameOf(object: number): string {
    return this.app.object(object)?.name ?? "?";
  }
}
