// SPDX-License-Identifier: Apache-2.0
// The state of the page in one place. Parts of the page read it and are told of its changes.
import type { Vec3 } from "./geometry";
import { findChanges, findTracks, type Track } from "./history";
import { kDefaultState, type LinkState } from "./link";
import type { Detection, ObjectEvent, Run, RunView, Scene, SceneObject } from "./protocol";
import type { Hypothesis } from "./trace";

export interface Store extends LinkState {
  /** A place that was picked without an object, or under the pointer. */
  point: Vec3 | null;
  event: ObjectEvent | null;
  /** The hypothesis of the view that is looked at. */
  hypothesis: Hypothesis | null;
  /** The view that is wholly on the screen; -1 while one is loading. */
  shownView: number;
  isPlaying: boolean;
  isMeasuring: boolean;
  measured: Vec3[];
  /** Counts the edits of the annotation. */
  edit: number;
}

export type Change = Partial<Store>;

export class App {
  private state: Store = {
    ...kDefaultState,
    point: null,
    event: null,
    hypothesis: null,
    shownView: -1,
    isPlaying: false,
    isMeasuring: false,
    measured: [],
    edit: 0,
  };
  private readonly listeners: ((changed: Set<keyof Store>) => void)[] = [];
  private tracksOf: Run | null = null;
  private knownTracks: Track[] = [];

  constructor(public scene: Scene) {}

  get(): Readonly<Store> {
    return this.state;
  }
  set(asked: Change): void {
    // What is looked at belongs to the view and to what is selected there.
    const isElsewhere = (["view", "run", "track", "object", "point"] as const).some(
      (key) => key in asked && asked[key] !== this.state[key],
    );
    const change: Change = isElsewhere ? { hypothesis: null, ...asked } : asked;
    const changed = new Set<keyof Store>();
    for (const key of Object.keys(change) as (keyof Store)[]) if (change[key] !== this.state[key]) changed.add(key);
    if (changed.size === 0) return;
    this.state = { ...this.state, ...change };
    for (const listener of this.listeners) listener(changed);
  }
  /** The scene itself has changed: everything is drawn anew. */
  setScene(scene: Scene): void {
    this.scene = scene;
    this.tracksOf = null;
    for (const listener of this.listeners) listener(new Set(Object.keys(this.state) as (keyof Store)[]));
  }
  listen(listener: (changed: Set<keyof Store>) => void): void {
    this.listeners.push(listener);
  }

  run(number: number = this.state.run): Run | undefined {
    return this.scene.runs[number];
  }
  runView(run: number = this.state.run, view: number = this.state.view): RunView | null {
    return this.scene.runs[run]?.views[view] ?? null;
  }
  /** The last view of the run with results; -1: none. */
  latestView(): number {
    const views = this.run()?.views ?? [];
    return views.reduce<number>((latest, view, index) => (view === null ? latest : index), -1);
  }
  object(number: number): SceneObject | undefined {
    return this.scene.objects[number];
  }
  tracks(): Track[] {
    const run = this.run();
    if (!run) return [];
    if (this.tracksOf !== run) {
      this.tracksOf = run;
      this.knownTracks = findTracks(run);
    }
    return this.knownTracks;
  }
  changes(): ObjectEvent[] {
    return findChanges(this.run());
  }
  /** The selected object in the current view. */
  selectedDetection(): Detection | null {
    return this.runView()?.detections.find((detection) => detection.track === this.state.track) ?? null;
  }
  /** Number of the object that is selected, by itself or by its track; -1: none. */
  selectedObject(): number {
    const { track, object } = this.state;
    return track >= 0 ? (this.tracks().find((each) => each.track === track)?.object ?? -1) : object;
  }
  /** Pose of the camera of a view: corrected, if there are results. */
  cameraPose(view: number): number[] | null {
    return this.run()?.views[view]?.pose ?? this.scene.views[view]?.pose ?? null;
  }

  goTo(view: number): void {
    const last = this.scene.views.length - 1;
    this.set({ view: Math.max(0, Math.min(last, view)) });
  }
  /** A single view has nothing to play. */
  togglePlaying(): void {
    this.set({ isPlaying: !this.state.isPlaying && this.scene.views.length > 1 });
  }
  selectTrack(track: number): void {
    this.set({ track, object: -1, point: null, event: null });
  }
  selectObject(object: number): void {
    this.set({ track: -1, object, point: null, event: null });
  }
  selectEvent(event: ObjectEvent): void {
    this.set({ view: event.view, track: event.track, object: -1, point: null, event });
  }
  selectNothing(): void {
    this.set({ track: -1, object: -1, point: null, event: null, measured: [] });
  }
}
