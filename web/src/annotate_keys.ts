// SPDX-License-Identifier: Apache-2.0
// The keyboard of the annotation.
import type { AnnotatePanel } from "./annotate_panel";
import { isIn } from "./annotation";
import type { Annotator } from "./annotator";
import { rotateVector, type Vec3 } from "./geometry";
import { movePose, turnPose } from "./pose_edit";
import type { Pose } from "./protocol";
import type { World } from "./world";

const kStepM = 0.001;
const kCoarse = 10;

/** Directions in the frame of the camera: x right, y down, z away. */
const kMoves: Record<string, Vec3> = {
  ArrowLeft: [-1, 0, 0],
  ArrowRight: [1, 0, 0],
  ArrowUp: [0, -1, 0],
  ArrowDown: [0, 1, 0],
  PageUp: [0, 0, 1],
  PageDown: [0, 0, -1],
};

/** Whether a key that is held down repeats what it does: moves, turns, and steps through views. */
export const mayRepeat = (key: string): boolean => /^(Arrow\w+|Page\w+|[,.;:<>np])$/i.test(key);

export class AnnotateKeys {
  constructor(
    private readonly annotator: Annotator,
    private readonly panel: AnnotatePanel,
    private readonly world: World,
  ) {}

  /** What a key does; undefined: it is not one of the annotation. */
  actionOf(event: KeyboardEvent): (() => void) | undefined {
    const { annotator, panel } = this;
    const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    const isControl = event.ctrlKey || event.metaKey;
    const direction = event.shiftKey ? kMoves[key] : undefined;
    if (direction) return () => this.move(direction, isControl ? kCoarse * kStepM : kStepM);
    if (isControl) {
      const commands: Record<string, () => void> = {
        z: () => (event.shiftKey ? annotator.redo() : annotator.undo()),
        y: () => annotator.redo(),
        s: () => annotator.export(),
      };
      return commands[key];
    }
    const actions: Record<string, () => void> = {
      s: () => (event.shiftKey ? annotator.snapAll() : annotator.snap()),
      g: () => panel.setGizmo({ mode: "translate" }),
      h: () => panel.setGizmo({ mode: "rotate" }),
      x: () => panel.setGizmo({ axes: panel.gizmo.axes === "world" ? "object" : "world" }),
      ",": () => this.turn(-1),
      "<": () => this.turn(-kCoarse),
      ";": () => this.turn(-kCoarse),
      ".": () => this.turn(1),
      ">": () => this.turn(kCoarse),
      ":": () => this.turn(kCoarse),
      i: () => annotator.cameHere(),
      o: () => annotator.leftHere(),
      v: () => annotator.movedHere(),
      y: () => panel.nextSymmetry(),
      Delete: () => annotator.remove(),
      k: () => annotator.check(),
      Tab: () => this.selectNext(event.shiftKey ? -1 : 1),
      Escape: () => {
        annotator.placing = -1;
        panel.masks.end();
        annotator.app.selectNothing();
        panel.show();
      },
    };
    return actions[key];
  }

  private selectNext(step: number): void {
    const { app, annotation } = this.annotator;
    const { view, track } = app.get();
    const tracks = annotation.objects.filter((each) => isIn(each, view)).map((each) => each.track);
    if (tracks.length === 0) return;
    const index = tracks.indexOf(track);
    app.selectTrack(tracks[(index + step + tracks.length) % tracks.length] ?? -1);
  }

  private move(inCamera: Vec3, metres: number): void {
    const camera = this.annotator.app.cameraPose(this.annotator.app.get().view);
    if (!camera) return;
    this.change((pose) => movePose(pose, rotateVector(camera, inCamera), metres, "world"));
  }
  private turn(degrees: number): void {
    const object = this.annotator.app.object(this.annotator.selected()?.object ?? -1);
    const { axes } = this.panel.gizmo;
    const axis: Vec3 = axes === "world" ? this.world.upward() : [0, 0, 1];
    this.change((pose) => turnPose(pose, object?.center ?? [0, 0, 0], axis, degrees, axes));
  }
  private change(by: (pose: Pose) => Pose): void {
    const pose = this.annotator.nudge(by);
    if (pose) this.world.gizmo().onDrag(pose);
  }
}
