// SPDX-License-Identifier: Apache-2.0
// The bar above the views: which run, which layers, which colours; and the overview of the keyboard.

import { kErrorColors, kEvidenceColors } from "./colors";
import { button, byId, element } from "./dom";
import { kCloudColors, kLayers, kObjectColors, type Layer, type ObjectColors } from "./link";
import type { App } from "./store";

export interface BarActions {
  exportPicture: () => void;
  copyLink: () => void;
  resetCamera: () => void;
}

const kLayerNames: Record<Layer, [string, string]> = {
  cloud: ["Cloud", "Points of the current view"],
  previous: ["Previous", "Points of the five views before it"],
  objects: ["Objects", "Models at the poses of the detections"],
  places: ["Old places", "Where objects were that have moved or gone"],
  truth: ["Truth", "Ground truth, where the sequence has it"],
  cameras: ["Cameras", "Cameras and their trajectory"],
  outlines: ["Outlines", "Outlines in the image"],
  labels: ["Labels", "Names of the objects"],
  changes: ["Changes", "Reconstruction of resight changes: removed points red, novel ones green"],
};

const kKeys: [string, string][] = [
  ["← →", "previous, next view"],
  ["Home End", "first, last view"],
  ["Space", "play, pause"],
  ["P N", "previous, next change"],
  ["Esc", "select nothing"],
  ["F", "look at the selected object"],
  ["C", "look from the camera of the view"],
  ["T", "look from above"],
  ["R", "reset the 3D view"],
  ["M", "measure a distance: click two places"],
  ["1 … 9", "layers on and off"],
  ["E", "export a picture"],
  ["L", "copy a link to this view, camera and selection"],
  ["D", "dark, light"],
  ["?", "this overview"],
];

const kAnnotateKeys: [string, string][] = [
  ["Ctrl+Z Ctrl+Y", "undo, redo"],
  ["Ctrl+S", "export"],
  ["S", "snap the selected object to all its views"],
  ["Shift+S", "snap all objects"],
  ["G H X", "handles move, turn, change their axes"],
  ["Shift+arrows", "move the object 1 mm left, right, up, down in the image (Ctrl: 10 mm)"],
  ["Shift+PgUp Shift+PgDn", "move it 1 mm away, nearer"],
  [", .", "turn it by 1° about the vertical axis of its handles (Shift: 10°)"],
  ["I O V", "it came, left, moved before this view"],
  ["Y", "next pose of the same shape"],
  ["Delete", "delete the placement"],
  ["K", "this view is checked"],
  ["Tab", "next object"],
];

export class Bar {
  private readonly help: HTMLDialogElement;

  constructor(
    root: HTMLElement,
    private readonly app: App,
    actions: BarActions,
  ) {
    this.help = makeHelp(app.scene.is_annotated ? [...kKeys, ...kAnnotateKeys] : kKeys);
    root.append(
      element("strong", {}, app.scene.title),
      ...(app.scene.runs.length > 0 && !app.scene.is_annotated ? this.makeRuns() : []),
      ...this.makeColors(),
      element("span", { class: "space" }),
      ...(app.scene.views.length > 0 ? [this.makeMeasure()] : []),
      button("Reset", "Reset the 3D view (R)", actions.resetCamera),
      button("Export", "Export a picture (E)", actions.exportPicture),
      button("Link", "Copy a link to this view, camera and selection (L)", actions.copyLink),
      button("◐", "Dark or light (D)", toggleTheme),
      button("?", "Keyboard overview (?)", () => this.help.showModal()),
    );
    document.body.append(this.help);
    byId("world").append(this.makeLayers(), this.makeLegend());
  }

  toggleLayer(index: number): void {
    const layer = kLayers[index];
    if (!layer) return;
    const layers = new Set(this.app.get().layers);
    if (!layers.delete(layer)) layers.add(layer);
    this.app.set({ layers });
  }
  showHelp(): void {
    this.help.showModal();
  }

  private makeRuns(): Node[] {
    const options = (prefix: string) =>
      this.app.scene.runs.map((run, index) => element("option", { value: index }, prefix + run.name));
    const run = element("select", { "aria-label": "Run", title: "Results that are shown" }, ...options(""));
    run.addEventListener("change", () => this.app.set({ run: Number(run.value), track: -1, event: null }));
    this.follow(() => {
      run.value = String(this.app.get().run);
    });
    if (this.app.scene.runs.length < 2) return [run];
    const none = element("option", { value: -1 }, "compare …");
    const compare = element(
      "select",
      { "aria-label": "Compare with", title: "Results beside them" },
      none,
      ...options("vs "),
    );
    compare.addEventListener("change", () => this.app.set({ compare: Number(compare.value) }));
    this.follow(() => {
      compare.value = String(this.app.get().compare);
    });
    return [run, compare];
  }

  private makeLayers(): HTMLElement {
    const { scene } = this.app;
    const hasViews = scene.views.length > 0;
    const isUseful = (layer: Layer) => {
      if (layer === "labels") return true;
      if (layer === "objects") return scene.runs.length > 0 || !hasViews;
      if (layer === "places" || layer === "outlines") return scene.runs.length > 0;
      if (layer === "changes") return scene.has_changes;
      return layer === "truth" ? scene.has_truth && !scene.is_annotated : hasViews;
    };
    const group = element("div", { class: "layers", role: "group", "aria-label": "Layers" });
    kLayers.forEach((layer, index) => {
      if (!isUseful(layer)) return;
      const [name, title] = kLayerNames[layer];
      const toggle = button(name, `${title} (${index + 1})`, () => this.toggleLayer(index), { "data-layer": layer });
      this.follow(() => toggle.setAttribute("aria-pressed", String(this.app.get().layers.has(layer))));
      group.append(toggle);
    });
    return group;
  }

  /** What the colours of the objects mean. */
  private makeLegend(): HTMLElement {
    const entries = (names: string[], colors: readonly string[]) =>
      names.map((name, index) => element("span", { class: "object", style: `--object-color: ${colors[index]}` }, name));
    const meanings: Partial<Record<ObjectColors, HTMLElement[]>> = {
      evidence: entries(["not seen", "occluded", "present", "seen through"], kEvidenceColors),
      error: entries(["depth 15 mm nearer", "as the model", "15 mm farther"], kErrorColors),
    };
    const legend = element("div", { class: "legend" });
    this.follow(() => {
      const meaning = meanings[this.app.get().objectColors];
      legend.replaceChildren(...(meaning ?? []));
      legend.hidden = !meaning;
    });
    return legend;
  }

  private makeColors(): Node[] {
    const choose = <T extends string>(
      label: string,
      names: readonly T[],
      texts: Record<T, string>,
      key: "objectColors" | "cloudColors",
    ) => {
      const select = element(
        "select",
        { "aria-label": label, title: label },
        ...names.map((name) => element("option", { value: name }, texts[name])),
      );
      select.addEventListener("change", () => this.app.set({ [key]: select.value as T }));
      this.follow(() => {
        select.value = this.app.get()[key];
      });
      return select;
    };
    const objects = choose(
      "Colours of the objects",
      kObjectColors,
      { own: "objects: own", label: "objects: label", evidence: "objects: evidence", error: "objects: depth error" },
      "objectColors",
    );
    if (this.app.scene.views.length === 0) return [];
    const cloud = choose(
      "Colours of the points",
      kCloudColors,
      { image: "points: colour", distance: "points: distance" },
      "cloudColors",
    );
    return this.app.scene.runs.length > 0 ? [objects, cloud] : [cloud];
  }

  private makeMeasure(): HTMLElement {
    const measure = button("Measure", "Measure a distance: click two places (M)", () =>
      this.app.set({ isMeasuring: !this.app.get().isMeasuring, measured: [] }),
    );
    this.follow(() => measure.setAttribute("aria-pressed", String(this.app.get().isMeasuring)));
    return measure;
  }

  private follow(show: () => void): void {
    this.app.listen(show);
    show();
  }
}

function makeHelp(shown: [string, string][]): HTMLDialogElement {
  const list = element("dl", { class: "keys" });
  for (const [keys, what] of shown) {
    const names = keys.split(" ").map((key) => element("kbd", {}, key));
    list.append(element("dt", {}, ...names), element("dd", {}, what));
  }
  const mouse = element(
    "p",
    {},
    "3D: drag to turn, right button to move, wheel to zoom. Click to select or to read a place.",
  );
  const licenses = element("a", { href: "/licenses.txt", target: "_blank" }, "Licences");
  const close = element("form", { method: "dialog" }, element("button", {}, "Close"), licenses);
  return element("dialog", { "aria-label": "Keyboard overview" }, element("h2", {}, "Keyboard"), list, mouse, close);
}

export function isDark(): boolean {
  const { theme } = document.documentElement.dataset;
  return theme ? theme === "dark" : window.matchMedia("(prefers-color-scheme: dark)").matches;
}

export function toggleTheme(): void {
  const theme = isDark() ? "light" : "dark";
  document.documentElement.dataset.theme = theme;
  localStorage.setItem("theme", theme);
  window.dispatchEvent(new Event("themechange"));
}

export function restoreTheme(): void {
  const theme = localStorage.getItem("theme");
  if (theme === "dark" || theme === "light") document.documentElement.dataset.theme = theme;
}
