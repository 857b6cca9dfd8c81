// SPDX-License-Identifier: Apache-2.0
// Handles to move and turn the selected object in the 3D view.
import { Matrix4, Object3D, type PerspectiveCamera, type Scene } from "three";
import { TransformControls } from "three/examples/jsm/controls/TransformControls.js";
import { multiply, type Vec3 } from "./geometry";
import { type Axes, isSamePose, translation } from "./pose_edit";
import type { Pose } from "./protocol";

const kSize = 0.7;

export class Gizmo {
  private readonly controls: TransformControls;
  private readonly handle = new Object3D();
  private center: Vec3 = [0, 0, 0];
  isDragging = false;
  private start: Pose = [];
  onDrag: (pose: Pose) => void = () => {};
  /** Called when a handle that was moved is released; a click on one moves nothing. */
  onDrop: (pose: Pose) => void = () => {};
  /** The camera must not turn while a handle is dragged. */
  onHold: (isHeld: boolean) => void = () => {};

  constructor(scene: Scene, camera: PerspectiveCamera, canvas: HTMLElement, requestDraw: () => void) {
    this.controls = new TransformControls(camera, canvas);
    this.controls.setSize(kSize);
    scene.add(this.handle, this.controls.getHelper());
    this.controls.addEventListener("change", requestDraw);
    this.controls.addEventListener("dragging-changed", (event) => {
      this.isDragging = event.value === true;
      this.onHold(this.isDragging);
      const pose = this.pose();
      if (this.isDragging) this.start = pose;
      else if (!isSamePose(pose, this.start)) this.onDrop(pose);
    });
    this.controls.addEventListener("objectChange", () => this.onDrag(this.pose()));
  }

  /** Shows the handles at the centre of an object; null hides them. */
  attach(pose: Pose | null, center: Vec3 = [0, 0, 0]): void {
    if (this.isDragging) return;
    if (!pose) {
      this.controls.detach();
      return;
    }
    this.center = center;
    const matrix = new Matrix4().fromArray(multiply(pose, translation(center)));
    matrix.decompose(this.handle.position, this.handle.quaternion, this.handle.scale);
    this.handle.updateMatrixWorld();
    this.controls.attach(this.handle);
  }
  setMode(mode: "translate" | "rotate", axes: Axes): void {
    this.controls.setMode(mode);
    this.controls.setSpace(axes === "object" ? "local" : "world");
  }
  /** Whether the pointer is on a handle. Not known when the button is released: the controls forget it before. */
  get isHovered(): boolean {
    return this.controls.axis !== null && this.controls.axis !== undefined;
  }

  private pose(): Pose {
    this.handle.updateMatrix();
    const back = this.center.map((value) => -value) as Vec3;
    return multiply(this.handle.matrix.toArray(), translation(back));
  }
}
