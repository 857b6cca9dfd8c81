// SPDX-License-Identifier: Apache-2.0
// What the server sends. Lengths are metres; a pose is a 4x4 matrix, column by column; null means unknown.

export type Pose = number[];

export interface SceneObject {
  name: string;
  obj_id: number;
  color: string;
  has_surface: boolean;
  center?: [number, number, number];
  diameter_m?: number;
  num_points?: number;
  num_sift?: number;
  num_shot?: number;
  num_symmetries?: number;
}

export interface Detection {
  object: number;
  track: number;
  score: number;
  fit: number;
  visible_share: number;
  verdict: string;
  pose: Pose;
}

export interface RunView {
  pose: Pose;
  detections: Detection[];
  novel_points: number;
  removed_points: number;
  changed_share: number | null;
  pose_suspect: boolean;
}

export type EventKind = "found" | "added" | "moved" | "removed" | "still_there" | "not_seen";

export interface ObjectEvent {
  view: number;
  kind: EventKind;
  object: number;
  track: number;
  before: Pose | null;
  after: Pose | null;
  confidence: number;
}

export interface Run {
  name: string;
  preset: string;
  version: string;
  /** What became of each hypothesis is known (trace.ts). */
  has_trace?: boolean;
  views: (RunView | null)[];
  events: ObjectEvent[];
}

export interface Scene {
  title: string;
  revision: number;
  is_live: boolean;
  /** The page annotates (annotation.ts). */
  is_annotated?: boolean;
  has_poses: boolean;
  has_truth: boolean;
  has_changes: boolean;
  views: { name: string; pose: Pose | null }[];
  objects: SceneObject[];
  runs: Run[];
}

export interface Camera {
  width: number;
  height: number;
  fx: number;
  fy: number;
  cx: number;
  cy: number;
}

/** Contours of columns and rows in turn. */
export type Outline = number[][];

export interface DetectionDetails {
  /** Of the placement, in an annotation. */
  id?: number;
  /** To the nearest true pose, up to the symmetries of the object; only where its model is known. */
  truth_error?: { center_distance_m: number; rotation_rad: number } | null;
  outline: Outline;
  covariance: number[] | null;
  evidence: {
    /** -1: unknown, as in traces. */
    view: number;
    allowed: boolean;
    visible_share: number | null;
    explained_share: number | null;
    color_share: number | null;
  }[];
}

export interface TrueObject {
  object: number;
  name: string;
  visible_share: number | null;
  pose: Pose;
  outline: Outline;
}

export interface ViewDetails {
  camera: Camera;
  detections: DetectionDetails[];
  truth: TrueObject[];
}

export interface Cloud {
  positions: Float32Array;
  normals: Int8Array | null;
  colors: Uint8Array | null;
}

/** Decodes a cloud (src/resight/viewer/binary_content.hpp). Throws if the bytes do not fit. */
export function decodeCloud(bytes: ArrayBuffer): Cloud {
  if (bytes.byteLength < 8) throw new Error("a cloud is cut off");
  const [count = 0, flags = 0] = new Uint32Array(bytes, 0, 2);
  const normalBytes = flags & 1 ? 3 * count : 0;
  const colorBytes = flags & 2 ? 3 * count : 0;
  if (bytes.byteLength !== 8 + 12 * count + normalBytes + colorBytes) throw new Error("a cloud is cut off");
  const positions = new Float32Array(bytes, 8, 3 * count);
  const end = 8 + 12 * count;
  return {
    positions,
    normals: normalBytes > 0 ? new Int8Array(bytes, end, normalBytes) : null,
    colors: colorBytes > 0 ? new Uint8Array(bytes, end + normalBytes, colorBytes) : null,
  };
}
