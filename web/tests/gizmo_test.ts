// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { test } from "node:test";
import { PerspectiveCamera, Scene } from "three";
import { Gizmo } from "../src/gizmo";
import { translation } from "../src/pose_edit";
import type { Pose } from "../src/protocol";

const kSize = 100;

/** As much of a canvas as the controls need. */
class FakeCanvas extends EventTarget {
  style = {};
  ownerDocument = {};
  getBoundingClientRect = () => ({ left: 0, top: 0, width: kSize, height: kSize });
  setPointerCapture(): void {}
  releasePointerCapture(): void {}
}
Object.assign(globalThis, { document: {} });

test("a click on a handle moves nothing, a drag does", () => {
  const scene = new Scene();
  const camera = new PerspectiveCamera(50, 1, 0.01, 10);
  camera.position.z = 1;
  const canvas = new FakeCanvas();
  const gizmo = new Gizmo(scene, camera, canvas as unknown as HTMLElement, () => {});
  const drops: Pose[] = [];
  gizmo.onDrop = (pose) => drops.push(pose);
  gizmo.attach(translation([0, 0, 0]));
  const send = (type: string, clientX: number) => {
    camera.updateMatrixWorld();
    scene.updateMatrixWorld();
    const button = type === "pointermove" ? -1 : 0;
    const at = { clientX, clientY: kSize / 2, button, pointerId: 1, pointerType: "mouse" };
    canvas.dispatchEvent(Object.assign(new Event(type), at));
  };
  for (const end of [50, 50.001, 60]) {
    send("pointermove", 50);
    send("pointerdown", 50);
    assert.ok(gizmo.isHovered && gizmo.isDragging);
    send("pointermove", end === 60 ? 60 : 50);
    send("pointerup", end);
    assert.ok(!gizmo.isHovered, "too late to ask");
    assert.equal(drops.length, end === 60 ? 1 : 0);
  }
  assert.ok((drops[0]?.[12] ?? 0) > 0.01);
});
