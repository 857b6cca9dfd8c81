// SPDX-License-Identifier: Apache-2.0
// The controls of the annotation, in place of the details of a detection.
import type { Placement, ViewResidual } from "./annotation";
import type { Annotator } from "./annotator";
import type { Api } from "./api";
import { parseColor } from "./colors";
import { button, element, percent } from "./dom";
import type { Vec3 } from "./geometry";
import type { MaskEditor } from "./mask_editor";
import { type Axes, fromNumbers, toNumbers } from "./pose_edit";
import { RegionList } from "./region_list";
import { drawThumbnail } from "./thumbnail";

const kNumberNames = ["x mm", "y mm", "z mm", "rx °", "ry °", "rz °"];

export interface GizmoState {
  mode: "translate" | "rotate";
  axes: Axes;
}

export class AnnotatePanel {
  readonly gizmo: GizmoState = { mode: "translate", axes: "world" };
  private readonly toolbar = element("div", { class: "tools" });
  private readonly selection = element("div", { class: "selection" });
  private readonly models = element("div", { class: "models-list" });
  private readonly search = element("input", {
    type: "search",
    placeholder: "Search models",
    "aria-label": "Search models",
  });
  private readonly regions: RegionList;
  private symmetriesOf = -1;
  private symmetries: number[][] = [];
  private symmetryIndex = 0;
  onGizmo: () => void = () => {};

  constructor(
    root: HTMLElement,
    private readonly annotator: Annotator,
    private readonly api: Api,
    readonly masks: MaskEditor,
  ) {
    this.regions = new RegionList(annotator);
    this.regions.onCorrect = (region) => masks.begin(region);
    masks.onChange = () => this.show();
    this.search.addEventListener("input", () => this.filterModels());
    root.replaceChildren(
      this.toolbar,
      this.selection,
      ...this.regions.parts(),
      element("h2", {}, "Place a model"),
      this.search,
      this.models,
    );
    this.makeModels();
    annotator.app.listen((changed) => {
      if (["view", "track", "edit"].some((key) => changed.has(key as "view"))) this.show();
    });
    this.show();
  }

  show(): void {
    this.showTools();
    this.showSelection();
    this.regions.show();
    this.filterModels();
  }

  private showTools(): void {
    const { annotator } = this;
    const { undo, redo, checked_views } = annotator.annotation;
    const { view } = annotator.app.get();
    const numViews = annotator.app.scene.views.length;
    const toggle = (label: string, title: string, isOn: boolean, action: () => void) =>
      button(label, title, action, { "aria-pressed": String(isOn) });
    const { mode, axes } = this.gizmo;
    this.toolbar.replaceChildren(
      button("Undo", undo ? `Undo: ${undo} (Ctrl+Z)` : "Nothing to undo", () => annotator.undo(), { disabled: !undo }),
      button("Redo", redo ? `Redo: ${redo} (Ctrl+Y)` : "Nothing to redo", () => annotator.redo(), { disabled: !redo }),
      toggle("Move", "Handles move the object (G)", mode === "translate", () => this.setGizmo({ mode: "translate" })),
      toggle("Turn", "Handles turn the object (H)", mode === "rotate", () => this.setGizmo({ mode: "rotate" })),
      button(axes === "world" ? "World axes" : "Object axes", "Axes of the world or of the object (X)", () =>
        this.setGizmo({ axes: axes === "world" ? "object" : "world" }),
      ),
      button("Export", "Write ground truth files (Ctrl+S)", () => annotator.export()),
      toggle("Checked", "Mark this view as checked (K)", checked_views.includes(view), () => annotator.check()),
      element(
        "span",
        { class: "progress" },
        `view ${view + 1} of ${numViews}, ${numViews - checked_views.length} unchecked`,
      ),
    );
  }
  setGizmo(change: Partial<GizmoState>): void {
    Object.assign(this.gizmo, change);
    this.showTools();
    this.onGizmo();
  }

  private showSelection(): void {
    if (this.masks.region >= 0) {
      this.selection.replaceChildren(...this.masks.controls());
      return;
    }
    const placement = this.annotator.selected();
    if (!placement) {
      const hint =
        this.annotator.placing >= 0
          ? `Click on ${this.annotator.nameOf(this.annotator.placing)} in the image or in 3D. Escape ends it.`
          : "Select an object, or choose a model below and click where it is.";
      this.selection.replaceChildren(element("p", { class: "hint" }, hint));
      return;
    }
    if (this.symmetriesOf !== placement.object) this.loadSymmetries(placement.object);
    const object = this.annotator.app.object(placement.object);
    this.selection.replaceChildren(
      element("h2", { class: "object", style: `--object-color: ${object?.color ?? "#888"}` }, object?.name ?? "?"),
      this.makeActions(placement),
      this.makeInterval(placement),
      this.makeNumbers(placement, object?.center ?? [0, 0, 0]),
      this.makeResiduals(placement),
    );
  }

  private makeActions(placement: Placement): HTMLElement {
    const { annotator } = this;
    const { view } = annotator.app.get();
    const others = [
      ...new Set(annotator.annotation.objects.filter((o) => o.object === placement.object).map((o) => o.track)),
    ];
    const track = element("select", {
      title: "The thing that it is: placements of one track are one thing that moves",
    });
    for (const each of others) track.append(element("option", { value: each }, `track ${each}`));
    track.append(element("option", { value: -1 }, "new track"));
    track.value = String(placement.track);
    track.addEventListener("change", () => annotator.joinTrack(Number(track.value)));
    return element(
      "div",
      { class: "tools" },
      button("Snap", "Fit to the depth of all views of the placement (S)", () => annotator.snap()),
      button("Came here", "It came before this view: the placement begins here (I)", () =>
        annotator.setInterval(view, Math.max(view, placement.last_view)),
      ),
      button("Left here", "It left before this view: the placement ends with the last one (O)", () =>
        this.endBefore(placement, view),
      ),
      button("Moved here", "It moved before this view: a second placement begins here (V)", () => annotator.split()),
      ...(this.symmetries.length > 0
        ? [button("Symmetry", "Take the next pose of the same shape (Y)", () => this.nextSymmetry())]
        : []),
      track,
      button("Delete", "Delete the placement (Delete)", () => annotator.remove()),
    );
  }
  endBefore(placement: Placement, view: number): void {
    if (view > placement.first_view) this.annotator.setInterval(placement.first_view, view - 1);
    else this.annotator.say("The placement begins here: delete it instead.", true);
  }

  private loadSymmetries(object: number): void {
    this.symmetriesOf = object;
    this.symmetries = [];
    this.symmetryIndex = 0;
    this.api.symmetries(object).then(
      (motions) => {
        if (this.symmetriesOf !== object) return;
        this.symmetries = motions;
        this.showSelection();
      },
      () => {},
    );
  }
  /** Steps through all poses of the same shape, and returns to the first one. */
  nextSymmetry(): void {
    const motion = this.symmetries[this.symmetryIndex];
    if (!motion) return;
    this.symmetryIndex = (this.symmetryIndex + 1) % this.symmetries.length;
    this.annotator.applySymmetry(motion);
  }

  private makeInterval(placement: Placement): HTMLElement {
    const make = (label: string, value: number) =>
      element("input", {
        type: "number",
        min: 1,
        max: this.annotator.app.scene.views.length,
        value: value + 1,
        "aria-label": label,
      });
    const first = make("First view", placement.first_view);
    const last = make("Last view", placement.last_view);
    for (const input of [first, last])
      input.addEventListener("change", () =>
        this.annotator.setInterval(first.valueAsNumber - 1, last.valueAsNumber - 1),
      );
    return element("div", { class: "interval" }, "views ", first, " to ", last);
  }

  private makeNumbers(placement: Placement, center: Vec3): HTMLElement {
    const grid = element("div", { class: "numbers" });
    const inputs = toNumbers(placement.pose, center).map((value, index) => {
      const name = kNumberNames[index] ?? "";
      const input = element("input", {
        type: "number",
        step: index < 3 ? 1 : 0.5,
        value: value.toFixed(2),
        "aria-label": name,
      });
      input.addEventListener("change", () => {
        const pose = fromNumbers(
          inputs.map((each) => each.valueAsNumber),
          center,
        );
        if (pose) this.annotator.setPose(pose);
        else this.annotator.say("A number is missing.", true);
      });
      grid.append(element("label", {}, name, input));
      return input;
    });
    return grid;
  }

  private makeResiduals(placement: Placement): HTMLElement {
    const { residuals, residualsOf } = this.annotator;
    const isCurrent = residualsOf?.every((value, i) => Math.abs(value - (placement.pose[i] ?? 0)) < 1e-9);
    if (!isCurrent)
      return button("Residual per view", "Compare with the depth of each view", () => this.annotator.showResiduals());
    const rows = residuals.filter((each) => each.num_visible > 0).map((each) => this.residualRow(each, placement));
    const head = ["view", "distance", "supported", ""].map((name) => element("th", { scope: "col" }, name));
    const table = element(
      "table",
      { class: "residuals" },
      element("thead", {}, element("tr", {}, ...head)),
      element("tbody", {}, ...rows),
    );
    return element("div", { class: "residual-box" }, table);
  }
  private residualRow(each: ViewResidual, placement: Placement): HTMLElement {
    const isInside = placement.first_view <= each.view && each.view <= placement.last_view;
    const note = each.is_gone ? (isInside ? "free space!" : "not there") : each.is_informative ? "" : "hardly seen";
    const cells = [String(each.view + 1), `${each.median_mm.toFixed(1)} mm`, percent(each.supported_share), note];
    const row = element(
      "tr",
      { class: each.is_gone && isInside ? "bad" : "" },
      ...cells.map((text) => element("td", {}, text)),
    );
    row.addEventListener("click", () => this.annotator.app.goTo(each.view));
    return row;
  }

  private makeModels(): void {
    this.annotator.app.scene.objects.forEach((object, index) => {
      const canvas = element("canvas", { class: "thumbnail", "aria-hidden": true });
      const entry = button("", `Place ${object.name}: click where it is`, () => this.startPlacing(index), {
        "data-model": object.name,
      });
      entry.append(canvas, element("span", {}, object.name));
      this.models.append(entry);
      if (object.has_surface)
        this.api.surface(index).then(
          (cloud) => drawThumbnail(canvas, cloud, parseColor(object.color)),
          () => {},
        );
    });
  }
  startPlacing(object: number): void {
    this.annotator.placing = this.annotator.placing === object ? -1 : object;
    this.annotator.app.selectNothing();
    this.show();
  }
  private filterModels(): void {
    const wanted = this.search.value.toLowerCase();
    for (const entry of this.models.querySelectorAll<HTMLElement>("button")) {
      const name = entry.dataset.model ?? "";
      entry.hidden = !name.toLowerCase().includes(wanted);
      entry.setAttribute("aria-pressed", String(this.annotator.nameOf(this.annotator.placing) === name));
    }
  }
}
