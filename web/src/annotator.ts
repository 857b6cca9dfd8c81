// SPDX-License-Identifier: Apache-2.0
// Edits of the annotation: sends them to the server and shows its answer.
import {
  type Action,
  type Annotation,
  type Change,
  type Placement,
  placementAt,
  presentInterval,
  putObject,
  type RegionKey,
  toRun,
  type ViewResidual,
} from "./annotation";
import { type Api, StatusError } from "./api";
import { multiply } from "./geometry";
import type { Pose } from "./protocol";
import type { App } from "./store";

export class Annotator {
  annotation: Annotation;
  /** Residuals of the selected object per view, of the pose `residualsOf`. */
  residuals: ViewResidual[] = [];
  residualsOf: Pose | null = null;
  /** Model that the next click places; -1: none. */
  placing = -1;
  private queue: Promise<unknown> = Promise.resolve();
  onChange: () => void = () => {};
  say: (text: string, isError?: boolean) => void = () => {};

  constructor(
    readonly app: App,
    private readonly api: Api,
    annotation: Annotation,
  ) {
    this.annotation = annotation;
  }

  selected(): Placement | null {
    const { track, view } = this.app.get();
    return track < 0 ? null : placementAt(this.annotation, track, view);
  }

  /** Runs jobs one after the other, so that each is based on the answer to the last one. */
  private run(job: () => Promise<void>): Promise<void> {
    const next = this.queue.then(async () => {
      document.body.dataset.busy = "yes";
      try {
        await job();
      } catch (error) {
        await this.onFailure(error);
      } finally {
        delete document.body.dataset.busy;
      }
    });
    this.queue = next;
    return next;
  }
  private async onFailure(error: unknown): Promise<void> {
    if (error instanceof StatusError && error.status === 409) {
      this.show(await this.api.annotation());
      this.say("Another window has changed the annotation. It is loaded again; please repeat your last step.", true);
      return;
    }
    this.say(error instanceof Error ? error.message : String(error), true);
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
    this.app.set({ edit: this.app.get().edit + 1 });
    document.body.dataset.revision = String(annotation.revision);
    this.onChange();
  }
  private async send(action: Action): Promise<void> {
    this.show(await this.api.act(this.annotation.revision, action));
  }

  edit(title: string, changes: Change[]): Promise<void> {
    return this.run(() => this.send({ title, changes }));
  }
  undo(): Promise<void> {
    return this.run(async () => {
      const { undo } = this.annotation;
      if (!undo) return;
      await this.send("undo");
      this.say(`Undone: ${undo}`);
    });
  }
  redo(): Promise<void> {
    return this.run(async () => {
      const { redo } = this.annotation;
      if (!redo) return;
      await this.send("redo");
      this.say(`Done again: ${redo}`);
    });
  }

  /** Places the chosen model at a pixel of the current view, and fits it to all views in which it is there. */
  place(u: number, v: number): Promise<void> {
    const object = this.placing;
    const { view } = this.app.get();
    return this.run(async () => {
      this.say("Placing …");
      const { pose } = await this.api.post<{ pose: Pose }>("place", { object, view, u, v });
      const numViews = this.app.scene.views.length;
      const found = await this.api.post<ViewResidual[]>("assess", { object, pose });
      const [first_view, last_view] = presentInterval(found, view, numViews);
      const refined = await this.refinePose(object, pose, first_view, last_view, true);
      this.placing = -1;
      await this.send({
        title: `Place ${this.nameOf(object)}`,
        changes: [putObject({ object, first_view, last_view, pose: refined })],
      });
      const added = this.annotation.objects.reduce<Placement | null>(
        (latest, each) => (latest && latest.id > each.id ? latest : each),
        null,
      );
      if (added) this.app.selectTrack(added.track);
      await this.assess();
      this.say(`${this.nameOf(object)} is in views ${first_view + 1} to ${last_view + 1}.`);
    });
  }

  setPose(pose: Pose, title = "Move"): Promise<void> {
    const placement = this.selected();
    if (!placement) return Promise.resolve();
    return this.edit(`${title} ${this.nameOf(placement.object)}`, [putObject({ ...placement, pose })]);
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
    if (answer.num_pairs < 30) throw new Error("No view shows enough of the object here. Move it nearer first.");
    return answer.pose;
  }

  /** Fits the selected object to all views of its placement. */
  snap(): Promise<void> {
    return this.run(async () => {
      const placement = this.selected();
      if (!placement) return;
      const { object, first_view, last_view } = placement;
      const pose = await this.refinePose(object, placement.pose, first_view, last_view);
      await this.send({ title: `Snap ${this.nameOf(object)}`, changes: [putObject({ ...placement, pose })] });
      await this.assess();
    });
  }
  /** Fits all objects, in one edit. */
  snapAll(): Promise<void> {
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
          if (error instanceof StatusError) throw error;
        }
      }
      if (changes.length > 0) await this.send({ title: "Snap all", changes });
      this.say(`${changes.length} of ${this.annotation.objects.length} objects fit the views.`);
    });
  }
  /** What each view says of the selected object. */
  async assess(): Promise<void> {
    const placement = this.selected();
    if (!placement) return;
    this.residuals = await this.api.post<ViewResidual[]>("assess", { object: placement.object, pose: placement.pose });
    this.residualsOf = placement.pose;
    this.onChange();
  }
  showResiduals(): Promise<void> {
    return this.run(() => this.assess());
  }

  /** Takes the equivalent pose under a symmetry motion. */
  applySymmetry(motion: Pose): Promise<void> {
    const placement = this.selected();
    return placement ? this.setPose(multiply(placement.pose, motion), "Turn by symmetry") : Promise.resolve();
  }

  setInterval(first_view: number, last_view: number): Promise<void> {
    const placement = this.selected();
    if (!placement) return Promise.resolve();
    return this.edit(`Views of ${this.nameOf(placement.object)}`, [putObject({ ...placement, first_view, last_view })]);
  }
  /** The object moved before the current view: its placement ends, and another one begins, to be moved. */
  split(): Promise<void> {
    const placement = this.selected();
    const { view } = this.app.get();
    if (!placement || view <= placement.first_view || view > placement.last_view) {
      this.say("Go to the first view after the move.", true);
      return Promise.resolve();
    }
    return this.edit(`Split ${this.nameOf(placement.object)}`, [
      putObject({ ...placement, last_view: view - 1 }),
      putObject({ ...placement, id: -1, first_view: view }),
    ]);
  }
  /** The selected thing goes on as the placement of another track of the same model, or apart from it. */
  joinTrack(track: number): Promise<void> {
    const placement = this.selected();
    if (!placement) return Promise.resolve();
    return this.run(async () => {
      await this.send({
        title: `Track of ${this.nameOf(placement.object)}`,
        changes: [putObject({ ...placement, track })],
      });
      const now = this.annotation.objects.find((each) => each.id === placement.id);
      if (now) this.app.selectTrack(now.track);
    });
  }
  remove(): Promise<void> {
    const placement = this.selected();
    if (!placement) return Promise.resolve();
    return this.edit(`Delete ${this.nameOf(placement.object)}`, [{ do: "drop_object", id: placement.id }]);
  }

  judge(region: number, verdict: "open" | "accepted" | "rejected", track = -1): Promise<void> {
    const key = this.annotation.regions[region]?.key;
    if (!key) return Promise.resolve();
    return this.edit(`Region ${verdict}`, [{ do: "judge_region", region: key, verdict, track }]);
  }
  /** Drops a decision about a region that is no longer proposed. */
  forget(region: RegionKey): Promise<void> {
    return this.edit("Forget a region", [{ do: "judge_region", region, verdict: "open", track: -1, mask: null }]);
  }
  /** `runs`: null takes the mask that was proposed. */
  correctMask(region: number, runs: number[] | null): Promise<void> {
    const found = this.annotation.regions[region];
    if (!found) return Promise.resolve();
    const { key, verdict, track } = found;
    return this.edit("Mask", [{ do: "judge_region", region: key, verdict, track, mask: runs }]);
  }
  /** An event of a thing without model where a region came or left. */
  addUnknown(region: number, name: string): Promise<void> {
    const found = this.annotation.regions[region];
    if (!found) return Promise.resolve();
    const isNovel = found.kind === "novel";
    const { key } = found;
    return this.edit(`Unknown thing ${isNovel ? "came" : "left"}`, [
      {
        do: "put_event",
        view: key.view,
        kind: isNovel ? "added" : "removed",
        name,
        before: isNovel ? null : key.center,
        after: isNovel ? key.center : null,
      },
      { do: "judge_region", region: key, verdict: "accepted", track: -1 },
    ]);
  }
  /** A thing without model moved from one region to the other, before the earlier of their views. */
  moveUnknown(one: number, other: number, name: string): Promise<void> {
    const found = [this.annotation.regions[one]?.key, this.annotation.regions[other]?.key];
    const from = found.find((key) => key?.kind === "removed");
    const to = found.find((key) => key?.kind === "novel");
    if (!from || !to) return Promise.resolve();
    const view = Math.min(from.view, to.view);
    return this.edit("Unknown thing moved", [
      { do: "put_event", view, kind: "moved", name, before: from.center, after: to.center },
      ...[from, to].map((region) => ({ do: "judge_region", region, verdict: "accepted", track: -1 })),
    ]);
  }
  dropEvent(id: number): Promise<void> {
    return this.edit("Delete event", [{ do: "drop_event", id }]);
  }
  check(): Promise<void> {
    const { view } = this.app.get();
    const is_checked = !this.annotation.checked_views.includes(view);
    return this.edit(`${is_checked ? "Check" : "Uncheck"} view ${view + 1}`, [{ do: "check_view", view, is_checked }]);
  }
  export(): Promise<void> {
    return this.run(async () => {
      this.say("Exporting …");
      const { folder } = await this.api.post<{ folder: string }>("export", {});
      this.say(`Exported to ${folder}`);
    });
  }

  nameOf(object: number): string {
    return this.app.object(object)?.name ?? "?";
  }
}
