// SPDX-License-Identifier: Apache-2.0
// Fills the 3D view with what the state asks for.
import { Matrix4, type Object3D } from "three";
import type { Api } from "./api";
import { distanceColors, errorColors, evidenceColors, plainColors } from "./colors";
import {
  depthErrors,
  depthToPoints,
  inverseRigid,
  multiply,
  transformPoint,
  translationDeviations,
  translationOf,
  type Vec3,
} from "./geometry";
import { isChange } from "./history";
import { PointSet } from "./points";
import type { Camera, Cloud, Pose } from "./protocol";
import type { App } from "./store";
import { type Label, makeAxes, makeCameras, makeEllipsoid, makeSegments, type Pickable, type World } from "./world";

const kNumPrevious = 5;
const kMaxCloudPoints = 320000;
const kPreviousStep = 3;
const kReconstructionSizeM = 0.006;
const kSurfaceSizeM = 0.0042;
const kEvidenceMarginM = 0.015;
const kObjectNearerM = 0.012;
/** Three standard deviations, ten times enlarged: they are about a millimetre. */
const kShownDeviations = 30;

interface Item {
  object: number;
  track: number;
  pose: Pose;
  kind: "detection" | "other" | "place" | "truth" | "hypothesis";
  /** For objects that the scene does not know. */
  name?: string;
}

/** Those above a half are drawn before the points of the view. */
const kOpacities: Record<Item["kind"], number> = {
  detection: 1,
  other: 0.6,
  hypothesis: 0.6,
  place: 0.35,
  truth: 0.35,
};
/** How the points of an item are drawn beside the detections of the run. */
const kTints: Partial<Record<Item["kind"], [string, number]>> = {
  other: ["#b68cff", 0.75],
  place: ["#e5484d", 0.75],
  truth: ["#ffffff", 0.8],
  hypothesis: ["#ffd400", 0.7],
};

export class SceneView {
  private camera: Camera | null = null;
  private readonly pickablesOf = new Map<string, Pickable[]>();
  private readonly versions = new Map<string, number>();
  private labels: Label[] = [];
  private readonly pointsOfTrack = new Map<number, PointSet>();
  /** What could not be drawn; the rest is. */
  onError: (error: unknown) => void = () => {};

  constructor(
    private readonly world: World,
    private readonly app: App,
    private readonly api: Api,
  ) {}

  /** Draws the parts that depend on what has changed. */
  async update(changed: ReadonlySet<string>): Promise<void> {
    const has = (...keys: string[]) => keys.some((key) => changed.has(key));
    if (has("layers")) this.showLayers();
    if (this.app.scene.views.length === 0) {
      if (has("object", "view")) await this.showModels();
      return;
    }
    if (has("measured")) this.showMeasured();
    const { view } = this.app.get();
    const { camera } = await this.api.view(view, this.runNumber());
    if (view !== this.app.get().view) return; // what has changed is drawn with the other view
    this.camera = camera;
    if (has("view", "run")) this.showCameras();
    this.world.setMarker(this.app.get().point);
    await Promise.all([
      has("view", "run", "layers", "cloudColors") ? this.showCloud() : null,
      has("view", "layers") ? this.showChanges() : null,
      has("view", "run", "layers", "track", "object", "event", "objectColors", "edit", "hypothesis", "compare")
        ? this.showItems()
        : null,
    ]);
  }

  /** Where the first view looks from, a little behind and above. */
  home(up: Vec3, camera: Camera, depth: ArrayLike<number>, pose: Pose): void {
    const values = Array.from(
      { length: 400 },
      (_, i) => depth[Math.floor(((i + 0.5) / 400) * depth.length)] ?? Number.NaN,
    )
      .filter((value) => value > 0)
      .sort((a, b) => a - b);
    const range = values[Math.floor(values.length / 2)] ?? 1;
    const eye = transformPoint(pose, [0, 0, -0.35 * range]);
    const position = eye.map((value, i) => value + 0.3 * range * (up[i] ?? 0)) as Vec3;
    this.world.setHome({ position, target: transformPoint(pose, [0, 0, range]) });
    this.camera = camera;
  }

  private runNumber(): number {
    return this.app.run() ? this.app.get().run : -1;
  }

  /** Numbers the drawings of a group, so that one that comes late does not replace a newer one. */
  private begin(name: string): () => boolean {
    const version = (this.versions.get(name) ?? 0) + 1;
    this.versions.set(name, version);
    return () => this.versions.get(name) === version;
  }

  private setGroup(name: string, objects: Object3D[], pickables: Pickable[]): void {
    this.world.setGroup(name, objects);
    this.pickablesOf.set(name, pickables);
    this.world.setPickables([...this.pickablesOf.values()].flat());
    this.showLayers();
  }

  private showLayers(): void {
    const { layers } = this.app.get();
    for (const name of ["cloud", "previous", "objects", "places", "truth", "cameras", "changes"] as const)
      this.world.setVisible(name, layers.has(name));
    this.world.setVisible("other", layers.has("objects"));
    this.world.setVisible("uncertainty", layers.has("objects"));
    this.world.setLabels(layers.has("labels") && (layers.has("objects") || !this.app.run()) ? this.labels : []);
  }

  private showCameras(): void {
    if (!this.camera) return;
    const poses = this.app.scene.views.map((_, view) => this.app.cameraPose(view));
    this.setGroup("cameras", makeCameras(poses, this.app.get().view, this.camera, "#8b949e", "#ffa51e"), []);
  }

  private showMeasured(): void {
    const [a, b] = this.app.get().measured;
    this.world.setGroup("measured", a && b ? [makeSegments([a, b], "#ffd400")] : []);
  }

  /** Null if there is no pose, or it is no longer wanted. */
  private async makeCloud(view: number, run: number, step: number, isCurrent: () => boolean): Promise<PointSet | null> {
    const pose = this.app.cameraPose(view);
    if (!pose) return null;
    const { camera } = await this.api.view(view, run);
    if (!isCurrent()) return null;
    const images = await this.api.viewImages(view, camera);
    if (!isCurrent()) return null;
    const finest = Math.max(step, Math.ceil(Math.sqrt((camera.width * camera.height) / kMaxCloudPoints)));
    const { positions, pixels } = depthToPoints(camera, images.depth, pose, finest);
    const depths = Float32Array.from(pixels, (pixel) => images.depth[pixel] ?? 0);
    const colors =
      this.app.get().cloudColors === "image"
        ? pickColors(images.pixels, pixels)
        : distanceColors(depths, ...depthRange(images.depth));
    const points = new PointSet(positions, colors, null, {
      sizeM: kSurfaceSizeM,
      nearerM: 0,
      isRound: false,
      opacity: 1,
    });
    points.isEven = true;
    points.setSizes(depths.map((z) => (1.3 * finest * z) / camera.fx)); // a little more than the distance of neighbours
    return points;
  }

  private async showCloud(): Promise<void> {
    const isCurrent = this.begin("cloud");
    const { view, layers } = this.app.get();
    const run = this.runNumber();
    const current = layers.has("cloud") ? await this.makeCloud(view, run, 1, isCurrent) : null;
    const previous: PointSet[] = [];
    if (layers.has("previous"))
      for (let v = Math.max(0, view - kNumPrevious); v < view; ++v) {
        const cloud = await this.makeCloud(v, run, kPreviousStep, isCurrent);
        if (cloud) previous.push(cloud);
      }
    if (!isCurrent()) return;
    const pickable = (points: PointSet): Pickable => ({ points, track: -1, object: -1 });
    this.setGroup("cloud", current ? [current] : [], current ? [pickable(current)] : []);
    this.setGroup("previous", previous, previous.map(pickable));
  }

  private async showChanges(): Promise<void> {
    const isCurrent = this.begin("changes");
    const { view, layers } = this.app.get();
    const isShown = this.app.scene.has_changes && layers.has("changes");
    const cloud = isShown ? await this.api.changes(view) : null;
    if (!isCurrent()) return;
    if (!cloud) {
      this.setGroup("changes", [], []);
      return;
    }
    const colors = cloud.colors ?? plainColors(cloud.positions.length / 3, "#888888");
    const style = { sizeM: kReconstructionSizeM, nearerM: 0, isRound: false, opacity: 1 };
    const points = new PointSet(cloud.positions, colors, null, style);
    this.setGroup("changes", [points], [{ points, track: -1, object: -1 }]);
  }

  private findItems(): Item[] {
    const { view } = this.app.get();
    const items: Item[] = [];
    for (const { object, track, pose } of this.app.runView()?.detections ?? [])
      items.push({ object, track, pose, kind: "detection" });
    for (const event of this.app.run()?.events ?? [])
      if (isChange(event.kind) && event.before && event.view <= view)
        items.push({ object: event.object, track: event.track, pose: event.before, kind: "place" });
    return items;
  }

  private async showItems(): Promise<void> {
    const isCurrent = this.begin("items");
    const { view, layers } = this.app.get();
    const items = this.findItems();
    if (layers.has("truth")) {
      const details = await this.api.view(view, this.runNumber());
      for (const { object, name, pose } of details.truth) items.push({ object, track: -1, pose, kind: "truth", name });
    }
    const { hypothesis, compare } = this.app.get();
    // Numbers of tracks mean the same within a run only.
    for (const { object, pose } of this.app.runView(compare)?.detections ?? [])
      items.push({ object, track: -1, pose, kind: "other" });
    if (hypothesis) items.push({ object: hypothesis.object, track: -1, pose: hypothesis.pose, kind: "hypothesis" });
    const drawn = await Promise.all(items.map((item) => this.makeItem(item)));
    const uncertainty = await this.makeUncertainty();
    if (!isCurrent()) return;
    this.pointsOfTrack.clear();
    items.forEach((item, index) => {
      const points = drawn[index]?.pickables[0]?.points;
      if (item.kind === "detection" && points) this.pointsOfTrack.set(item.track, points);
    });
    const groups = {
      detection: "objects",
      place: "places",
      truth: "truth",
      hypothesis: "hypothesis",
      other: "other",
    } as const;
    for (const [kind, group] of Object.entries(groups)) {
      const parts = drawn.filter((_, index) => items[index]?.kind === kind);
      const lines = kind === "place" ? this.makeMoves() : [];
      this.setGroup(
        group,
        [...parts.flatMap((part) => part.objects), ...lines],
        parts.flatMap((part) => part.pickables),
      );
    }
    this.world.setGroup("uncertainty", uncertainty);
    const named = this.app.run() ? "detection" : "truth";
    this.labels = items.filter((item) => item.kind === named).map((item) => this.makeLabel(item));
    this.showLayers();
  }

  private isSelected(item: Item): boolean {
    const { track, object } = this.app.get();
    return track >= 0 ? item.track === track : object >= 0 && item.object === object;
  }

  private makeLabel(item: Item): Label {
    const object = this.app.object(item.object);
    const center = transformPoint(item.pose, object?.center ?? [0, 0, 0]);
    return {
      text: object?.name ?? item.name ?? "?",
      position: center,
      color: object?.color ?? "#ffffff",
      isSelected: this.isSelected(item),
    };
  }

  private async makeItem(item: Item): Promise<{ objects: Object3D[]; pickables: Pickable[] }> {
    const object = this.app.object(item.object);
    const axes =
      this.isSelected(item) && item.kind !== "place" ? makeAxes(item.pose, 0.6 * (object?.diameter_m ?? 0.1)) : [];
    if (!object?.has_surface) return { objects: axes.length > 0 ? axes : makeAxes(item.pose, 0.05), pickables: [] };
    const surface = await this.api.surface(item.object);
    const points = new PointSet(surface.positions, await this.surfaceColors(item, surface), surface.normals, {
      sizeM: kSurfaceSizeM,
      nearerM: kOpacities[item.kind] > 0.5 ? kObjectNearerM : 0,
      isRound: true,
      opacity: kOpacities[item.kind],
    });
    points.matrix = new Matrix4().fromArray(item.pose);
    const pickable = { points, track: item.track, object: item.object };
    const tint = kTints[item.kind];
    if (tint) points.setTint(...tint);
    else if (this.isSelected(item)) points.setTint(object.color, 0.45);
    return { objects: [points, ...axes], pickables: item.kind === "hypothesis" ? [] : [pickable] };
  }

  /** The ellipsoid in which the centre of the selected object is, enlarged. */
  private async makeUncertainty(): Promise<Object3D[]> {
    const detection = this.app.selectedDetection();
    const index = detection ? (this.app.runView()?.detections.indexOf(detection) ?? -1) : -1;
    if (!detection || index < 0) return [];
    const details = await this.api.view(this.app.get().view, this.runNumber());
    const covariance = details.detections[index]?.covariance;
    if (!covariance) return [];
    const object = this.app.object(detection.object);
    const axes = translationDeviations(covariance).map((value) => kShownDeviations * value);
    return makeEllipsoid(transformPoint(detection.pose, object?.center ?? [0, 0, 0]), axes, "#ffd400");
  }

  private async surfaceColors(item: Item, surface: Cloud): Promise<Uint8Array> {
    const { objectColors, view } = this.app.get();
    const object = this.app.object(item.object);
    const count = surface.positions.length / 3;
    if (item.kind === "detection" && (objectColors === "evidence" || objectColors === "error")) {
      const pose = this.app.cameraPose(view);
      if (pose && this.camera) {
        const { depth } = await this.api.viewImages(view, this.camera);
        const cameraFromObject = multiply(inverseRigid(pose), item.pose);
        const { positions, normals } = surface;
        const errors = depthErrors(positions, normals, cameraFromObject, this.camera, depth);
        return (objectColors === "error" ? errorColors : evidenceColors)(errors, kEvidenceMarginM);
      }
    }
    if (objectColors === "own" && surface.colors) return surface.colors;
    return plainColors(count, object?.color ?? "#888888");
  }

  /** Dashed lines from old to new places. */
  private makeMoves(): Object3D[] {
    const { view } = this.app.get();
    const lines: Object3D[] = [];
    for (const event of this.app.run()?.events ?? []) {
      if (event.kind !== "moved" || event.view > view || !event.before || !event.after) continue;
      const object = this.app.object(event.object);
      const center: Vec3 = object?.center ?? [0, 0, 0];
      const ends = [event.before, event.after].map((pose) => transformPoint(pose, center));
      lines.push(makeSegments(ends, object?.color ?? "#ffffff", true));
    }
    return lines;
  }

  /** All models side by side, or the selected one alone. */
  private async showModels(): Promise<void> {
    const isCurrent = this.begin("items");
    const { objects } = this.app.scene;
    const { object: selected } = this.app.get();
    const columns = Math.ceil(Math.sqrt(objects.length));
    const spacing = 1.15 * Math.max(0.05, ...objects.map((object) => object.diameter_m ?? 0.3));
    const parts: PointSet[] = [];
    const pickables: Pickable[] = [];
    const faults: string[] = [];
    this.labels = [];
    for (const [index, object] of objects.entries()) {
      if (selected >= 0 && selected !== index) continue;
      const surface = await this.api.surface(index).catch((error: Error) => {
        faults.push(`${object.name} (${error.message})`);
        return null;
      });
      if (!isCurrent()) return;
      if (!surface) continue;
      const colors = surface.colors ?? plainColors(surface.positions.length / 3, object.color);
      const style = { sizeM: kSurfaceSizeM, nearerM: 0, isRound: true, opacity: 1 };
      const points = new PointSet(surface.positions, colors, surface.normals, style);
      const place: Vec3 =
        selected >= 0 ? [0, 0, 0] : [(index % columns) * spacing, -Math.floor(index / columns) * spacing, 0];
      points.matrix = new Matrix4().setPosition(...place);
      parts.push(points);
      pickables.push({ points, track: -1, object: index });
      const isSelected = false;
      this.labels.push({ text: object.name, position: place, color: object.color, isSelected });
    }
    const side = selected >= 0 ? 0 : (columns - 1) * spacing;
    const target: Vec3 = [side / 2, -side / 2, 0];
    const range = selected >= 0 ? 2 * (objects[selected]?.diameter_m ?? 0.3) : 1.2 * (side + spacing);
    this.world.setHome({ position: [target[0], target[1] - 0.6 * range, 0.9 * range], target });
    this.setGroup("objects", [...parts, ...(selected >= 0 ? makeAxes(new Matrix4().toArray(), 0.05) : [])], pickables);
    this.world.goHome();
    if (faults.length > 0) this.onError(new Error(`cannot be shown: ${faults.join(", ")}`));
  }

  /** Draws an object elsewhere while it is dragged. */
  movePoints(track: number, pose: Pose): void {
    const points = this.pointsOfTrack.get(track);
    if (!points) return;
    points.matrix = new Matrix4().fromArray(pose);
    points.matrixWorldNeedsUpdate = true;
    this.world.requestDraw();
  }

  /** Centre and size of what is selected. */
  selectedPlace(): { center: Vec3; size: number } | null {
    const item = this.findItems().find((each) => this.isSelected(each));
    const object = item ? this.app.object(item.object) : undefined;
    if (!item) return null;
    const center = object?.center ? transformPoint(item.pose, object.center) : translationOf(item.pose);
    return { center, size: object?.diameter_m ?? 0.2 };
  }
}

function pickColors(image: Uint8ClampedArray, pixels: Uint32Array): Uint8Array {
  const colors = new Uint8Array(3 * pixels.length);
  for (let i = 0; i < pixels.length; ++i)
    for (let c = 0; c < 3; ++c) colors[3 * i + c] = image[4 * (pixels[i] ?? 0) + c] ?? 0;
  return colors;
}

/** The 2nd and 98th percentile of a depth image. */
function depthRange(depth: Float32Array): [number, number] {
  const sample: number[] = [];
  const step = Math.max(1, Math.floor(depth.length / 4000));
  for (let i = 0; i < depth.length; i += step) {
    const value = depth[i] ?? 0;
    if (value > 0) sample.push(value);
  }
  sample.sort((a, b) => a - b);
  const at = (share: number) => sample[Math.floor(share * (sample.length - 1))] ?? 1;
  return [at(0.02), at(0.98)];
}
