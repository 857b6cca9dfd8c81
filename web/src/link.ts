// SPDX-License-Identifier: Apache-2.0
// The state of the page in the fragment of its address, so that it survives a reload and can be kept as a link.
import type { Vec3 } from "./geometry";

export const kLayers = [
  "cloud",
  "previous",
  "objects",
  "places",
  "truth",
  "cameras",
  "outlines",
  "labels",
  "changes",
] as const;
export type Layer = (typeof kLayers)[number];

export const kDefaultLayers: readonly Layer[] = ["cloud", "objects", "places", "cameras", "outlines", "labels"];

export type ObjectColors = "own" | "label" | "evidence" | "error";
export const kObjectColors: readonly ObjectColors[] = ["own", "label", "evidence", "error"];
export type CloudColors = "image" | "distance";
export const kCloudColors: readonly CloudColors[] = ["image", "distance"];

export interface CameraState {
  position: Vec3;
  target: Vec3;
}

export interface LinkState {
  view: number;
  run: number;
  /** Run beside it; -1: none. */
  compare: number;
  /** Selected track of the run; -1: none. */
  track: number;
  /** Selected object where there are no tracks; -1: none. */
  object: number;
  layers: ReadonlySet<Layer>;
  objectColors: ObjectColors;
  cloudColors: CloudColors;
  camera: CameraState | null;
}

export const kDefaultState: LinkState = {
  view: 0,
  run: 0,
  compare: -1,
  track: -1,
  object: -1,
  layers: new Set(kDefaultLayers),
  objectColors: "own",
  cloudColors: "image",
  camera: null,
};

const kDigits = 4;

export function formatLink(state: LinkState, token: string): string {
  const parts = new URLSearchParams({ token });
  if (state.view !== 0) parts.set("view", String(state.view));
  if (state.run !== 0) parts.set("run", String(state.run));
  if (state.compare >= 0) parts.set("compare", String(state.compare));
  if (state.track >= 0) parts.set("track", String(state.track));
  if (state.object >= 0) parts.set("object", String(state.object));
  const layers = kLayers.filter((layer) => state.layers.has(layer));
  if (layers.join() !== kLayers.filter((layer) => kDefaultLayers.includes(layer)).join())
    parts.set("layers", layers.join("."));
  if (state.objectColors !== "own") parts.set("objects", state.objectColors);
  if (state.cloudColors !== "image") parts.set("points", state.cloudColors);
  if (state.camera) {
    const numbers = [...state.camera.position, ...state.camera.target].map((value) => Number(value.toFixed(kDigits)));
    parts.set("camera", numbers.join("_"));
  }
  return `#${parts}`;
}

function readNumber(text: string | null, none: number, count: number): number {
  if (text === null || !/^\d{1,9}$/.test(text)) return none;
  const value = Number(text);
  return value < count ? value : none;
}

function readCamera(text: string | null): CameraState | null {
  const numbers = (text ?? "").split("_").map(Number);
  if (numbers.length !== 6 || !numbers.every((value) => Number.isFinite(value))) return null;
  const [a = 0, b = 0, c = 0, d = 0, e = 0, f = 0] = numbers;
  return { position: [a, b, c], target: [d, e, f] };
}

/** Reads a fragment; anything that does not fit the scene takes its default. */
export function parseLink(
  fragment: string,
  counts: { views: number; runs: number; objects: number },
): { token: string; state: LinkState } {
  const parts = new URLSearchParams(fragment.replace(/^#/, ""));
  const layers = parts.get("layers");
  const named = (layers ?? "").split(".");
  return {
    token: parts.get("token") ?? "",
    state: {
      view: readNumber(parts.get("view"), 0, counts.views),
      run: readNumber(parts.get("run"), 0, counts.runs),
      compare: readNumber(parts.get("compare"), -1, counts.runs),
      track: readNumber(parts.get("track"), -1, 1e9),
      object: readNumber(parts.get("object"), -1, counts.objects),
      layers: new Set(layers === null ? kDefaultLayers : kLayers.filter((layer) => named.includes(layer))),
      objectColors: kObjectColors.find((name) => name === parts.get("objects")) ?? "own",
      cloudColors: kCloudColors.find((name) => name === parts.get("points")) ?? "image",
      camera: readCamera(parts.get("camera")),
    },
  };
}
