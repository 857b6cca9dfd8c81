// SPDX-License-Identifier: Apache-2.0
// The annotation as the server keeps it, and what the page derives from it. No page needed.
import type { Vec3 } from "./geometry";
import type { Detection, EventKind, ObjectEvent, Pose, Run } from "./protocol";

/** An object at one place, in the views from first_view to last_view. */
export interface Placement {
  id: number;
  track: number;
  object: number;
  first_view: number;
  last_view: number;
  pose: Pose;
}

/** A region as decisions name it: not by a number, so that they survive another detection. */
export interface RegionKey {
  view: number;
  kind: "novel" | "removed";
  center: Vec3;
}

export interface Region {
  key: RegionKey;
  view: number;
  kind: "novel" | "removed";
  num_points: number;
  /** Of its box in the world. */
  pose: Pose;
  size_m: Vec3;
  verdict: "open" | "accepted" | "rejected";
  track: number;
  /** Its mask was corrected by hand. */
  is_corrected: boolean;
  is_explained: boolean;
}

/** Pixels of a region: first pixel and number of pixels of each run in turn. */
export interface RegionPixels {
  proposed: number[];
  corrected: number[] | null;
}

export interface UnknownEvent {
  id: number;
  view: number;
  kind: "added" | "moved" | "removed";
  name: string;
  before: Vec3 | null;
  after: Vec3 | null;
}

export interface ToDo {
  kind: string;
  view: number;
  track: number;
  region: number;
  text: string;
  /** A region that was judged, but is no longer proposed. */
  lost: RegionKey | null;
}

export interface Annotation {
  revision: number;
  /** Titles of the edits that undo and redo concern; empty: none. */
  undo: string;
  redo: string;
  objects: Placement[];
  checked_views: number[];
  regions: Region[];
  events: {
    view: number;
    kind: EventKind;
    track: number;
    object: number;
    name: string;
    before: Pose | null;
    after: Pose | null;
  }[];
  unknown_events: UnknownEvent[];
  to_dos: ToDo[];
}

export interface ViewResidual {
  view: number;
  num_visible: number;
  supported_share: number;
  median_mm: number;
  is_informative: boolean;
  is_gone: boolean;
  is_used: boolean;
}

/** A change that the server knows (docs/annotate.md). */
export type Change = { do: string; [key: string]: unknown };
export type Action = "undo" | "redo" | { title: string; changes: Change[] };

/** An annotation in the form of a run, so that all parts of the page show it. */
export function toRun(annotation: Annotation, viewPoses: (Pose | null)[]): Run {
  const views = viewPoses.map((pose, view) => ({
    pose: pose ?? [],
    detections: annotation.objects.filter((each) => isIn(each, view)).map(toDetection),
    novel_points: 0,
    removed_points: 0,
    changed_share: null,
    pose_suspect: false,
  }));
  const events: ObjectEvent[] = annotation.events
    .filter((event) => event.track >= 0)
    .map(({ view, kind, track, object, before, after }) => ({
      view,
      kind,
      track,
      object,
      before,
      after,
      confidence: 1,
    }));
  return { name: "annotation", preset: "", version: "", views, events };
}

const toDetection = ({ object, track, pose }: Placement): Detection => ({
  object,
  track,
  pose,
  score: 1,
  fit: 1,
  visible_share: 1,
  verdict: "",
});

export const isIn = (placement: Placement, view: number): boolean =>
  placement.first_view <= view && view <= placement.last_view;

/** The placement of a track in a view; else the one before it, or else the first one. */
export function placementAt(annotation: Annotation, track: number, view: number): Placement | null {
  const placements = annotation.objects
    .filter((each) => each.track === track)
    .sort((a, b) => a.first_view - b.first_view);
  return (
    placements.find((each) => isIn(each, view)) ??
    placements.filter((each) => each.first_view <= view).pop() ??
    placements[0] ??
    null
  );
}

/** The placement of a track that a region may come from: what came is in the view of the region, what left was there
 * before. */
export function placementBeside(annotation: Annotation, track: number, { kind, view }: Region): Placement | null {
  const seen = kind === "novel" ? view : view - 1;
  const placement = placementAt(annotation, track, seen);
  if (!placement || placement.first_view > seen) return null;
  return kind === "removed" || isIn(placement, seen) ? placement : null;
}

/** The views around `view` in which the object may be: up to those that show free space at its place. */
export function presentInterval(residuals: ViewResidual[], view: number, numViews: number): [number, number] {
  const gone = residuals.filter((each) => each.is_gone).map((each) => each.view);
  const first = Math.max(-1, ...gone.filter((each) => each < view)) + 1;
  const last = Math.min(numViews, ...gone.filter((each) => each > view)) - 1;
  return [first, last];
}

/** The views at the ends of that interval of which no residual tells. As it ends at free space, it may be shorter. */
export function unknownEnds(residuals: ViewResidual[], view: number, numViews: number): [number, number][] {
  const [first, last] = presentInterval(residuals, view, numViews);
  const there = residuals.map((each) => each.view).filter((each) => first <= each && each <= last);
  const ends: [number, number][] = [];
  if (first > 0) ends.push([first, Math.min(view, ...there) - 1]);
  if (last < numViews - 1) ends.push([Math.max(view, ...there) + 1, last]);
  return ends.filter(([begin, end]) => begin <= end);
}

/** A placement that begins at a view. If it has ended before, the thing came back: another placement of its track begins
 * there, up to the next one or the last view. */
export function beginAt(placement: Placement, view: number, all: readonly Placement[], numViews: number): Placement {
  if (view <= placement.last_view) return { ...placement, first_view: view };
  const later = all.filter((each) => each.track === placement.track && each.first_view > view);
  const last_view = Math.min(numViews, ...later.map((each) => each.first_view)) - 1;
  return { ...placement, id: -1, first_view: view, last_view };
}
/** A placement that ends before a view. */
export function endBefore(placement: Placement, view: number): Placement {
  if (view <= placement.first_view) throw new Error("The placement begins here: delete it instead.");
  return { ...placement, last_view: view - 1 };
}
/** A placement that ends before a view, and the next one of the same thing, which begins there. */
export function splitAt(placement: Placement, view: number): Placement[] {
  if (view <= placement.first_view || view > placement.last_view)
    throw new Error("Go to the first view after the move.");
  return [endBefore(placement, view), { ...placement, id: -1, first_view: view }];
}

export const putObject = (placement: Omit<Placement, "id" | "track"> & { id?: number; track?: number }): Change => ({
  do: "put_object",
  id: placement.id ?? -1,
  track: placement.track ?? -1,
  object: placement.object,
  first_view: placement.first_view,
  last_view: placement.last_view,
  pose: placement.pose,
});
