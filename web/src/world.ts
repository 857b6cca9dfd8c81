// SPDX-License-Identifier: Apache-2.0
// The 3D view: what stands where, and the camera that looks at it. Draws only when something has changed.
import {
  BufferGeometry,
  Float32BufferAttribute,
  Group,
  Line,
  LineBasicMaterial,
  LineDashedMaterial,
  LineSegments,
  Matrix4,
  Mesh,
  MeshBasicMaterial,
  type Object3D,
  PerspectiveCamera,
  Scene,
  SphereGeometry,
  Vector2,
  Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { pickPoint, transformPoint, type Vec3 } from "./geometry";
import { Gizmo } from "./gizmo";
import type { CameraState } from "./link";
import { PointSet } from "./points";
import type { Camera, Pose } from "./protocol";

/** What can be picked: points with what they belong to. */
export interface Pickable {
  points: PointSet;
  track: number;
  object: number;
}

export interface Picked {
  position: Vec3;
  track: number;
  object: number;
}

export interface Label {
  text: string;
  position: Vec3;
  color: string;
  isSelected: boolean;
}

const kPickRadiusPx = 7;
const kFrustumDepthM = 0.08;
const kMaxFrusta = 150;
const kSlowFrameMs = 80;
const kPauseMs = 5000; // a longer one was no frame
const kMinShare = 1 / 16;

export class World {
  readonly canvas: HTMLCanvasElement;
  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly camera = new PerspectiveCamera(50, 1, 0.01, 200);
  private readonly controls: OrbitControls;
  private readonly groups = new Map<string, Group>();
  private readonly labelLayer: HTMLElement;
  private labels: { element: HTMLElement; position: Vec3 }[] = [];
  private pickables: Pickable[] = [];
  /** An element: the pointer moves it without drawing all points anew. */
  private readonly marker: HTMLElement;
  private marked: Vec3 | null = null;
  private isDirty = false;
  private isMoving = false;
  private lastDrawnMs = 0;
  private movingShare = 1;
  private knownGizmo: Gizmo | null = null;
  private home: CameraState = { position: [1, -1, 1], target: [0, 0, 0] };
  /** Called when the user has moved the camera. */
  onMove: () => void = () => {};

  constructor(
    private readonly host: HTMLElement,
    private readonly up: Vec3,
  ) {
    this.canvas = document.createElement("canvas");
    this.canvas.tabIndex = 0;
    this.canvas.setAttribute("aria-label", "3D view: drag to turn, right button to move, wheel to zoom");
    this.labelLayer = document.createElement("div");
    this.labelLayer.className = "labels3d";
    this.labelLayer.setAttribute("aria-hidden", "true");
    this.marker = document.createElement("div");
    this.marker.className = "marker";
    this.marker.hidden = true;
    this.labelLayer.append(this.marker);
    host.append(this.canvas, this.labelLayer);
    // The drawing is kept, so that it can be exported and checked at any time.
    this.renderer = new WebGLRenderer({ canvas: this.canvas, antialias: true, preserveDrawingBuffer: true });
    this.camera.up.set(...up); // OrbitControls reads it once
    this.controls = new OrbitControls(this.camera, this.canvas);
    this.controls.zoomToCursor = true;
    this.controls.addEventListener("change", () => {
      this.requestDraw();
      this.onMove();
    });
    this.controls.addEventListener("start", () => {
      this.isMoving = true;
    });
    this.controls.addEventListener("end", () => {
      this.isMoving = false;
      this.requestDraw();
    });
    new ResizeObserver(() => this.resize()).observe(host);
    this.resize();
  }

  private resize(): void {
    const width = Math.max(1, this.host.clientWidth);
    const height = Math.max(1, this.host.clientHeight);
    this.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio));
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.requestDraw();
  }

  setBackground(color: string): void {
    this.renderer.setClearColor(color);
    this.requestDraw();
  }

  /** Replaces all that is drawn under a name. */
  setGroup(name: string, objects: Object3D[]): void {
    const old = this.groups.get(name);
    if (old) {
      this.scene.remove(old);
      old.traverse((object) => {
        const { geometry, material } = object as Mesh;
        geometry?.dispose();
        for (const each of Array.isArray(material) ? material : [material]) each?.dispose();
      });
    }
    const group = new Group();
    for (const object of objects) group.add(object);
    this.groups.set(name, group);
    this.scene.add(group);
    this.requestDraw();
  }
  setVisible(name: string, isVisible: boolean): void {
    const group = this.groups.get(name);
    if (!group || group.visible === isVisible) return;
    group.visible = isVisible;
    this.requestDraw();
  }
  /** Handles for the selected object; made when they are first needed. */
  gizmo(): Gizmo {
    if (!this.knownGizmo) {
      this.knownGizmo = new Gizmo(this.scene, this.camera, this.canvas, () => this.requestDraw());
      this.knownGizmo.onHold = (isHeld) => {
        this.controls.enabled = !isHeld;
      };
    }
    return this.knownGizmo;
  }
  setPickables(pickables: Pickable[]): void {
    this.pickables = pickables;
  }
  setLabels(labels: Label[]): void {
    this.labelLayer.replaceChildren(this.marker);
    this.labels = labels.map((label) => {
      const element = document.createElement("span");
      element.textContent = label.text;
      element.style.setProperty("--label-color", label.color);
      if (label.isSelected) element.className = "selected";
      element.hidden = true; // until the next drawing places it
      this.labelLayer.append(element);
      return { element, position: label.position };
    });
    this.requestDraw();
  }
  setMarker(position: Vec3 | null): void {
    this.marked = position;
    this.placeMarker();
  }

  requestDraw(): void {
    if (this.isDirty) return;
    this.isDirty = true;
    requestAnimationFrame(() => this.draw());
  }
  /** Draws at once. */
  draw(): void {
    this.isDirty = false;
    this.adaptShare();
    const share = this.isMoving ? this.movingShare : 1;
    const height = this.renderer.getDrawingBufferSize(new Vector2()).y;
    this.scene.traverse((object) => {
      if (!(object instanceof PointSet)) return;
      object.fitScreen(this.camera, height);
      if (object.isEven) object.setShare(share);
    });
    this.renderer.render(this.scene, this.camera);
    this.placeLabels();
    this.placeMarker();
  }

  /** While the camera moves, a machine that is too slow for all points draws as many as it can. */
  private adaptShare(): void {
    const now = performance.now();
    const elapsedMs = now - this.lastDrawnMs;
    this.lastDrawnMs = now;
    if (!this.isMoving || elapsedMs > kPauseMs) return;
    const change =
      elapsedMs > kSlowFrameMs ? Math.max(0.25, kSlowFrameMs / elapsedMs) : elapsedMs < kSlowFrameMs / 2 ? 1.2 : 1;
    this.movingShare = Math.min(1, Math.max(kMinShare, change * this.movingShare));
  }

  private placeLabels(): void {
    for (const { element, position } of this.labels) this.placeElement(element, position, "translate(-50%, -100%)");
  }
  private placeMarker(): void {
    this.placeElement(this.marker, this.marked, "translate(-50%, -50%)");
  }
  /** Puts an element at a point of the last drawing; `offset`: from there. */
  private placeElement(element: HTMLElement, position: Vec3 | null, offset: string): void {
    const point = position ? new Vector3(...position).project(this.camera) : null;
    element.hidden = !(point && point.z < 1 && Math.abs(point.x) < 1 && Math.abs(point.y) < 1);
    if (!point || element.hidden) return;
    const x = (point.x + 1) * 0.5 * this.host.clientWidth;
    const y = (1 - point.y) * 0.5 * this.host.clientHeight;
    element.style.transform = `${offset} translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)`;
  }

  /** The point under a position of the canvas, in CSS pixels. Objects win over clouds that are up to 2 cm nearer. */
  pick(x: number, y: number): Picked | null {
    let best: Picked | null = null;
    let bestDepth = Number.POSITIVE_INFINITY;
    const clipFromWorld = new Matrix4().multiplyMatrices(this.camera.projectionMatrix, this.camera.matrixWorldInverse);
    for (const { points, track, object } of this.pickables) {
      if (!points.parent?.visible) continue;
      const clip = clipFromWorld.clone().multiply(points.matrix);
      const hit = pickPoint(
        points.positions,
        clip.elements,
        this.host.clientWidth,
        this.host.clientHeight,
        x,
        y,
        kPickRadiusPx,
      );
      if (!hit) continue;
      const depth = hit.depth - (object >= 0 ? 0.02 : 0);
      if (depth >= bestDepth) continue;
      bestDepth = depth;
      const at = (axis: number) => points.positions[3 * hit.index + axis] ?? 0;
      best = { position: transformPoint(points.matrix.elements, [at(0), at(1), at(2)]), track, object };
    }
    return best;
  }

  cameraState(): CameraState {
    return { position: this.camera.position.toArray(), target: this.controls.target.toArray() };
  }
  setCamera(state: CameraState): void {
    this.camera.position.set(...state.position);
    this.controls.target.set(...state.target);
    this.controls.update();
    this.requestDraw();
  }
  setHome(state: CameraState): void {
    this.home = state;
  }
  goHome(): void {
    this.setCamera(this.home);
  }
  /** Looks from where a camera of the sequence is. */
  lookFrom(pose: Pose, distance: number): void {
    this.setCamera({ position: transformPoint(pose, [0, 0, 0]), target: transformPoint(pose, [0, 0, distance]) });
  }
  /** Turns to a place, from the side it is seen from now. */
  lookAt(target: Vec3, distance: number): void {
    const direction = this.camera.position.clone().sub(this.controls.target).normalize().multiplyScalar(distance);
    this.setCamera({ position: new Vector3(...target).add(direction).toArray(), target });
  }
  /** The direction that is up. */
  upward(): Vec3 {
    return this.up;
  }
  /** Looks down on the target. */
  lookDown(): void {
    const distance = this.camera.position.distanceTo(this.controls.target);
    const sideways = new Vector3().crossVectors(new Vector3(...this.up), new Vector3(0.123, 0.456, 0.789));
    const position = this.controls.target
      .clone()
      .addScaledVector(new Vector3(...this.up), distance)
      .addScaledVector(sideways.normalize(), 1e-3 * distance);
    this.setCamera({ position: position.toArray(), target: this.controls.target.toArray() });
  }
}

/** Lines between pairs of points. */
export function makeSegments(points: Vec3[], color: string, isDashed = false): LineSegments {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new Float32BufferAttribute(points.flat(), 3));
  const material = isDashed
    ? new LineDashedMaterial({ color, dashSize: 0.02, gapSize: 0.012 })
    : new LineBasicMaterial({ color });
  const lines = new LineSegments(geometry, material);
  if (isDashed) lines.computeLineDistances();
  return lines;
}

export function makePath(points: Vec3[], color: string): Line {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new Float32BufferAttribute(points.flat(), 3));
  return new Line(geometry, new LineBasicMaterial({ color }));
}

/** The pyramid that a camera sees. */
export function makeFrustum(pose: Pose, camera: Camera, color: string, depth = kFrustumDepthM): LineSegments {
  const corner = (u: number, v: number): Vec3 =>
    transformPoint(pose, [((u - camera.cx) / camera.fx) * depth, ((v - camera.cy) / camera.fy) * depth, depth]);
  const eye = transformPoint(pose, [0, 0, 0]);
  const corners = [
    corner(0, 0),
    corner(camera.width, 0),
    corner(camera.width, camera.height),
    corner(0, camera.height),
  ];
  const points: Vec3[] = [];
  corners.forEach((p, i) => {
    points.push(eye, p, p, corners[(i + 1) % 4] ?? p);
  });
  return makeSegments(points, color);
}

/** The trajectory with some of its cameras, and the current one. */
export function makeCameras(
  poses: (Pose | null)[],
  current: number,
  camera: Camera,
  color: string,
  currentColor: string,
): Object3D[] {
  const known = poses.filter((pose): pose is Pose => pose !== null);
  const objects: Object3D[] = [
    makePath(
      known.map((pose) => transformPoint(pose, [0, 0, 0])),
      color,
    ),
  ];
  const step = Math.ceil(poses.length / kMaxFrusta);
  poses.forEach((pose, view) => {
    if (pose && view !== current && view % step === 0) objects.push(makeFrustum(pose, camera, color, 0.04));
  });
  const pose = poses[current];
  if (pose) objects.push(makeFrustum(pose, camera, currentColor));
  return objects;
}

/** The edges of a box around the origin of a pose. */
export function makeBox(pose: Pose, size: Vec3, color: string): LineSegments {
  const corner = (i: number): Vec3 =>
    transformPoint(pose, [0, 1, 2].map((axis) => ((i >> axis) & 1 ? 0.5 : -0.5) * (size[axis] ?? 0)) as Vec3);
  const points: Vec3[] = [];
  for (let i = 0; i < 8; ++i) for (const bit of [1, 2, 4]) if ((i & bit) === 0) points.push(corner(i), corner(i | bit));
  return makeSegments(points, color);
}

/** An ellipsoid around a place, before everything else. `axes`: a 3x3 matrix, column by column, that the unit sphere is
 * multiplied with. */
export function makeEllipsoid(center: Vec3, axes: readonly number[], color: string): Object3D[] {
  const column = (c: number) => [axes[3 * c] ?? 0, axes[3 * c + 1] ?? 0, axes[3 * c + 2] ?? 0, 0];
  const matrix = new Matrix4().fromArray([...column(0), ...column(1), ...column(2), ...center, 1]);
  return [0.25, 0.6].map((opacity, index) => {
    const style = { color, opacity, transparent: true, depthTest: false, wireframe: index === 1 };
    const mesh = new Mesh(new SphereGeometry(1, 16, 10), new MeshBasicMaterial(style));
    mesh.matrixAutoUpdate = false;
    mesh.matrix = matrix;
    mesh.renderOrder = 1;
    return mesh;
  });
}

export function makeAxes(pose: Pose, length: number): LineSegments[] {
  const origin = transformPoint(pose, [0, 0, 0]);
  return [
    makeSegments([origin, transformPoint(pose, [length, 0, 0])], "#e5484d"),
    makeSegments([origin, transformPoint(pose, [0, length, 0])], "#30a46c"),
    makeSegments([origin, transformPoint(pose, [0, 0, length])], "#3e7bfa"),
  ];
}
