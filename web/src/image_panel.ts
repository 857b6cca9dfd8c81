// SPDX-License-Identifier: Apache-2.0
// The image of the current view with the outlines of its objects.
import type { Api, ViewImages } from "./api";
import { element } from "./dom";
import { inverseRigid, multiply, project, transformPoint, unproject, type Vec3 } from "./geometry";
import type { Point } from "./mask";
import type { Camera, Detection, Outline, Pose, ViewDetails } from "./protocol";
import type { App } from "./store";

interface Shape {
  path: Path2D;
  track: number;
  object: number;
  color: string;
  name: string;
  /** Shown behind the name where there is room. */
  note: string;
  top: [number, number];
  isTruth: boolean;
  verdict: string;
}

const kMinNoteWidthPx = 380;
const kMovedStep = 3; // of the points of a surface
const kTruthColor = "#ffffff";

function toPath(outline: Outline): { path: Path2D; top: [number, number] } {
  const path = new Path2D();
  let top: [number, number] = [0, Number.POSITIVE_INFINITY];
  for (const contour of outline) {
    for (let i = 0; i + 1 < contour.length; i += 2) {
      const [x = 0, y = 0] = [contour[i], contour[i + 1]];
      if (y < top[1]) top = [x, y];
      if (i === 0) path.moveTo(x + 0.5, y + 0.5);
      else path.lineTo(x + 0.5, y + 0.5);
    }
    path.closePath();
  }
  return { path, top };
}

export interface PointedAt {
  view: number;
  pixel: [number, number];
  depth: number;
  position: Vec3 | null;
}

/** Takes the pointer as long as it is used; positions are pixels. */
export interface PointerTool {
  press: (at: Point) => void;
  drag: (at: Point) => void;
  release: () => void;
}

export class ImagePanel {
  readonly root: HTMLElement;
  private readonly canvas: HTMLCanvasElement;
  private readonly caption: HTMLElement;
  private images: ViewImages | null = null;
  private details: ViewDetails | null = null;
  /** What the image is of: until another one is there, clicks in it are meant for this one. */
  private shown = { view: 0, run: -1 };
  private shapes: Shape[] = [];
  private wanted = "";
  onPoint: (at: PointedAt | null) => void = () => {};
  onPick: (at: PointedAt) => void = () => {};
  /** Takes a click before anything else; false: it does not want it. */
  onPlace: (at: PointedAt) => boolean = () => false;
  tool: PointerTool | null = null;
  /** Draws over the image, in pixels of it; `pixel` is one of the screen. */
  overlay: (context: CanvasRenderingContext2D, pixel: number) => void = () => {};
  private moved: Path2D | null = null;

  /** `run`: which run it shows; -1 for none. */
  constructor(
    private readonly app: App,
    private readonly api: Api,
    private readonly runOf: () => number,
  ) {
    this.canvas = element("canvas", { tabindex: 0, role: "img", "aria-label": "Image of the view" });
    this.caption = element("figcaption");
    this.root = element("figure", { class: "image" }, this.canvas, this.caption);
    this.canvas.addEventListener("pointerleave", () => this.onPoint(null));
    this.canvas.addEventListener("click", (event) => this.pick(event));
    this.listenToTool();
    new ResizeObserver(() => this.draw()).observe(this.root);
  }

  private listenToTool(): void {
    const { canvas } = this;
    canvas.addEventListener("pointerdown", (event) => {
      if (!this.tool || !this.details || event.button !== 0) return;
      canvas.setPointerCapture(event.pointerId);
      this.tool.press(this.position(event, this.details.camera));
    });
    canvas.addEventListener("pointermove", (event) => {
      if (!this.tool || !this.details || !canvas.hasPointerCapture(event.pointerId)) this.onPoint(this.locate(event));
      else this.tool.drag(this.position(event, this.details.camera));
    });
    canvas.addEventListener("pointerup", (event) => {
      if (this.tool && canvas.hasPointerCapture(event.pointerId)) this.tool.release();
    });
  }

  /** Loads what the state asks for; what is shown stays until that is there. */
  async update(): Promise<void> {
    const { view, edit } = this.app.get();
    const run = this.runOf();
    this.wanted = `${view}/${run}/${edit}`;
    const wanted = this.wanted;
    const isWanted = () => this.wanted === wanted && this.app.get().view === view;
    const details = await this.api.view(view, run);
    if (!isWanted()) return; // its images are not needed any more
    const images = await this.api.viewImages(view, details.camera);
    if (!isWanted()) return;
    this.details = details;
    this.images = images;
    this.shown = { view, run };
    this.moved = null;
    this.makeShapes(run, view, details);
    this.setCaption(run, view);
    this.draw();
  }

  private setCaption(run: number, view: number): void {
    const name = this.app.scene.views[view]?.name ?? "";
    const parts = [`${view + 1}/${this.app.scene.views.length} · ${name}`];
    const shown = this.app.run(run);
    if (shown && !this.app.scene.is_annotated)
      parts.push(this.app.runView(run, view) ? shown.name : `${shown.name}: no results for this view`);
    this.caption.textContent = parts.join(" · ");
    this.canvas.setAttribute(
      "aria-label",
      `Image of view ${view + 1}, ${this.visibleShapes().length} objects outlined`,
    );
  }

  private makeShapes(run: number, view: number, details: ViewDetails): void {
    this.shapes = [];
    for (const object of details.truth) {
      const { path, top } = toPath(object.outline);
      const color = kTruthColor;
      this.shapes.push({
        path,
        top,
        track: -1,
        object: object.object,
        color,
        name: object.name,
        note: "",
        isTruth: true,
        verdict: "",
      });
    }
    const detections: Detection[] = this.app.runView(run, view)?.detections ?? [];
    detections.forEach((detection, index) => {
      const { path, top } = toPath(details.detections[index]?.outline ?? []);
      const object = this.app.object(detection.object);
      const isWrong = detection.verdict === "false" || detection.verdict === "ghost";
      this.shapes.push({
        path,
        top,
        track: detection.track,
        object: detection.object,
        color: object?.color ?? "#fff",
        name: `${isWrong ? `${detection.verdict}: ` : ""}${object?.name ?? "?"}`,
        note: this.app.scene.is_annotated ? "" : ` ${detection.score.toFixed(2)}`,
        isTruth: false,
        verdict: detection.verdict,
      });
    });
  }

  draw(): void {
    const images = this.images;
    if (!images || !this.details) return;
    const { width, height } = this.details.camera;
    const box = this.root.getBoundingClientRect();
    const scale = Math.max(0.05, Math.min(box.width / width, (box.height - this.caption.offsetHeight) / height));
    const ratio = Math.min(2, window.devicePixelRatio);
    this.canvas.style.width = `${Math.floor(width * scale)}px`;
    this.canvas.style.height = `${Math.floor(height * scale)}px`;
    this.canvas.width = Math.floor(width * scale * ratio);
    this.canvas.height = Math.floor(height * scale * ratio);
    const context = this.canvas.getContext("2d");
    if (!context) return;
    const zoom = this.canvas.width / width;
    context.setTransform(zoom, 0, 0, zoom, 0, 0);
    context.drawImage(images.bitmap, 0, 0, width, height);
    this.drawShapes(context, 1 / (scale || 1));
    if (this.moved) {
      context.fillStyle = "rgba(255, 212, 0, 0.55)";
      context.fill(this.moved);
    }
    this.overlay(context, 1 / (scale || 1));
    this.drawPoint(context, 1 / (scale || 1));
  }

  /** Shows the points of an object at another pose: while it is dragged, or of a hypothesis. Null shows none. */
  async showMoved(shown: { object: number; pose: Pose } | null): Promise<void> {
    const cameraPose = this.pose();
    if (!shown && !this.moved) return;
    this.moved = null;
    if (!shown || !this.app.object(shown.object)?.has_surface || !cameraPose || !this.details) {
      this.draw();
      return;
    }
    const { object, pose } = shown;
    const { camera } = this.details;
    const { positions } = await this.api.surface(object);
    const cameraFromObject = multiply(inverseRigid(cameraPose), pose);
    const path = new Path2D();
    for (let i = 0; i + 2 < positions.length; i += 3 * kMovedStep) {
      const p: Vec3 = [positions[i] ?? 0, positions[i + 1] ?? 0, positions[i + 2] ?? 0];
      const pixel = project(camera, transformPoint(cameraFromObject, p));
      if (pixel) path.rect(pixel[0] - 0.5, pixel[1] - 0.5, 2, 2);
    }
    this.moved = path;
    this.draw();
  }

  private visibleShapes(): Shape[] {
    const { layers } = this.app.get();
    return this.shapes.filter((shape) => (shape.isTruth ? layers.has("truth") : layers.has("outlines")));
  }

  private isSelected(shape: Shape): boolean {
    const { track, run } = this.app.get();
    // Numbers of tracks mean the same within a run only.
    if (!shape.isTruth && this.shown.run === run && track >= 0) return shape.track === track;
    return shape.object >= 0 && shape.object === this.app.selectedObject();
  }

  private drawShapes(context: CanvasRenderingContext2D, pixel: number): void {
    const shapes = this.visibleShapes();
    for (const shape of shapes) {
      const isSelected = this.isSelected(shape);
      const isDashed = shape.isTruth || shape.verdict === "false" || shape.verdict === "ghost";
      context.setLineDash(isDashed ? [5 * pixel, 3 * pixel] : []);
      if (isSelected) {
        context.fillStyle = `${shape.color}40`;
        context.fill(shape.path);
      }
      context.lineJoin = "round";
      context.strokeStyle = "rgba(0, 0, 0, 0.7)";
      context.lineWidth = (isSelected ? 5 : 3.5) * pixel;
      context.stroke(shape.path);
      context.strokeStyle = shape.color;
      context.lineWidth = (isSelected ? 3 : 1.7) * pixel;
      context.stroke(shape.path);
    }
    context.setLineDash([]);
    if (this.app.get().layers.has("labels")) this.drawLabels(context, shapes, pixel);
  }

  private drawLabels(context: CanvasRenderingContext2D, shapes: Shape[], pixel: number): void {
    const { width = 0 } = this.details?.camera ?? {};
    const size = 11 * pixel;
    const taken: { x: number; y: number; width: number }[] = [];
    context.font = `600 ${size}px system-ui, sans-serif`;
    context.textBaseline = "middle";
    const isWide = width / pixel > kMinNoteWidthPx;
    for (const shape of shapes) {
      if (!Number.isFinite(shape.top[1])) continue;
      const label = shape.name + (isWide ? shape.note : "");
      const labelWidth = context.measureText(label).width + 8 * pixel;
      const x = Math.max(0, Math.min(width - labelWidth, shape.top[0] - labelWidth / 2));
      let y = Math.max(0, shape.top[1] - 1.7 * size);
      const overlaps = () =>
        taken.some((t) => Math.abs(t.y - y) < 1.5 * size && x < t.x + t.width && t.x < x + labelWidth);
      for (let tries = 0; tries < 12 && overlaps(); ++tries) y += 1.5 * size;
      taken.push({ x, y, width: labelWidth });
      context.fillStyle = this.isSelected(shape) ? shape.color : "rgba(10, 14, 20, 0.78)";
      context.beginPath();
      context.roundRect(x, y, labelWidth, 1.4 * size, 3 * pixel);
      context.fill();
      context.fillStyle = this.isSelected(shape) ? "#0a0e14" : shape.color;
      context.fillText(label, x + 4 * pixel, y + 0.72 * size);
    }
  }

  private drawPoint(context: CanvasRenderingContext2D, pixel: number): void {
    const { point } = this.app.get();
    const pose = this.pose();
    if (!point || !pose || !this.details) return;
    const at = project(this.details.camera, transformPoint(inverseRigid(pose), point));
    if (!at) return;
    for (const [color, width] of [
      ["#000", 4],
      ["#ffd400", 2],
    ] as const) {
      context.strokeStyle = color;
      context.lineWidth = width * pixel;
      context.beginPath();
      context.arc(at[0] + 0.5, at[1] + 0.5, 5 * pixel, 0, 2 * Math.PI);
      context.stroke();
    }
  }

  /** Of the camera that took the image. */
  private pose(): number[] | null {
    const { view, run } = this.shown;
    return this.app.runView(run, view)?.pose ?? this.app.cameraPose(view);
  }

  /** In pixels, whose centres are whole numbers. */
  private position(event: MouseEvent, camera: Camera): Point {
    const box = this.canvas.getBoundingClientRect();
    return [
      ((event.clientX - box.left) / box.width) * camera.width - 0.5,
      ((event.clientY - box.top) / box.height) * camera.height - 0.5,
    ];
  }

  private locate(event: MouseEvent): PointedAt | null {
    if (!this.details || !this.images) return null;
    const { camera } = this.details;
    const [u, v] = this.position(event, camera).map(Math.round) as [number, number];
    if (u < 0 || v < 0 || u >= camera.width || v >= camera.height) return null;
    const depth = this.images.depth[v * camera.width + u] ?? Number.NaN;
    const pose = this.pose();
    const position = depth > 0 && pose ? transformPoint(pose, unproject(camera, u, v, depth)) : null;
    return { view: this.shown.view, pixel: [u, v], depth, position };
  }

  private pick(event: MouseEvent): void {
    const at = this.locate(event);
    if (!at || this.tool) return;
    if (this.onPlace(at)) return;
    if (this.app.get().isMeasuring) {
      this.onPick(at);
      return;
    }
    const context = this.canvas.getContext("2d");
    const [x, y] = [at.pixel[0] + 0.5, at.pixel[1] + 0.5];
    context?.setTransform(1, 0, 0, 1, 0, 0);
    // The one that was drawn last lies on top; of a detection and the truth, the detection counts.
    const hit = this.visibleShapes()
      .filter((shape) => context?.isPointInPath(shape.path, x, y))
      .pop();
    if (!hit) this.onPick(at);
    else if (hit.isTruth || this.shown.run !== this.app.get().run) this.app.selectObject(hit.object);
    else this.app.selectTrack(hit.track);
  }

  /** The picture as it is shown. */
  picture(): HTMLCanvasElement {
    return this.canvas;
  }
}
