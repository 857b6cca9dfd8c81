// SPDX-License-Identifier: Apache-2.0
// The controls of the annotation, in place of the details of a detection.
import type { Placement, ViewResidual } from "./annotation";
import type { Annotator } from "./annotator";
import type { Api } from "./api";
import { parseColor } from "./colors";
import { button, element, percent } from "./dom";
import type { Vec3 } from "./geometry";
import type { MaskEditor } from "./mask_editor";
import { type Axes, isSamePose, nextSymmetryStep, toNumbers } from "./pose_edit";
import { RegionList } from "./region_list";
import { drawThumbnail } from "./thumbnail";

const kNumberNames = ["x mm", "y mm", "z mm", "rx °", "ry °", "rz °"];

export interface GizmoState {
  mode: "translate" | "rotate";
  axes: Axes;
}

/** What is typed stays. */
function setValue(input: HTMLInputElement, value: string): void {
  if (input !== document.activeElement) input.value = value;
}

export class AnnotatePanel {
  readonly gizmo: GizmoState = { mode: "translate", axes: "world" };
  private readonly toolbar = element("div", { class: "tools" });
  private readonly selection = element("div", { class: "selection" });
  private readonly residuals = element("div");
  private readonly models = element("div", { class: "models-list" });
  private readonly search = element("input", {
    type: "search",
    placeholder: "Search models",
    "aria-label": "Search models",
  });
  private readonly regions: RegionList;
  /** The placement whose controls are shown; -1: none. They stay, and `fill` gives them its values: a control that is
   * typed into or pressed must not be replaced. */
  private shownId = -1;
  private fill: ((now: Placement) => void)[] = [];
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
    // What was typed gives way to what is stored, once that is known.
    this.selection.addEventListener("focusout", () => annotator.idle().then(() => this.fillIn()));
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
    const placement = this.masks.region >= 0 ? null : this.annotator.selected();
    if (!placement) {
      this.shownId = -1;
      this.selection.replaceChildren(...(this.masks.region >= 0 ? this.masks.controls() : [this.makeHint()]));
      return;
    }
    if (this.shownId !== placement.id) this.makeSelection(placement);
    this.fillIn();
    this.residuals.replaceChildren(this.makeResiduals(placement));
  }
  private fillIn(): void {
    const placement = this.annotator.selected();
    if (placement?.id === this.shownId) for (const fill of this.fill) fill(placement);
  }
  private makeHint(): HTMLElement {
    const { placing } = this.annotator;
    const hint =
      placing >= 0
        ? `Click on ${this.annotator.nameOf(placing)} in the image or in 3D. Escape ends it.`
        : "Select an object, or choose a model below and click where it is.";
    return element("p", { class: "hint" }, hint);
  }
  private makeSelection(placement: Placement): void {
    this.shownId = placement.id;
    this.fill = [];
    this.loadSymmetries(placement.object);
    const object = this.annotator.app.object(placement.object);
    this.selection.replaceChildren(
      element("h2", { class: "object", style: `--object-color: ${object?.color ?? "#888"}` }, object?.name ?? "?"),
      this.makeActions(placement),
      this.makeInterval(placement.id),
      this.makeNumbers(placement.id, object?.center ?? [0, 0, 0]),
      this.residuals,
    );
  }

  private makeActions(placement: Placement): HTMLElement {
    const { annotator } = this;
    const symmetry = button("Symmetry", "Take the next pose of the same shape (Y)", () => this.nextSymmetry());
    this.fill.push(() => {
      symmetry.hidden = this.symmetries.length === 0;
    });
    return element(
      "div",
      { class: "tools" },
      button("Snap", "Fit to the depth of all views of the placement (S)", () => annotator.snap()),
      button("Came here", "It came before this view, or came back: a placement begins here (I)", () =>
        annotator.cameHere(),
      ),
      button("Left here", "It left before this view: the placement ends with the last one (O)", () =>
        annotator.leftHere(),
      ),
      button("Moved here", "It moved before this view: a second placement begins here (V)", () =>
        annotator.movedHere(),
      ),
      symmetry,
      this.makeTrack(placement),
      button("Delete", "Delete the placement (Delete)", () => annotator.remove()),
    );
  }
  private makeTrack({ id, object }: Placement): HTMLElement {
    const { annotator } = this;
    const select = element("select", {
      title: "The thing that it is: placements of one track are one thing that moves",
    });
    select.addEventListener("change", () => annotator.joinTrack(id, Number(select.value)));
    let listed: string | null = null;
    this.fill.push((now) => {
      const same = annotator.annotation.objects.filter((each) => each.object === object);
      const tracks = [...new Set(same.map((each) => each.track))];
      if (listed !== tracks.join()) {
        const options = tracks.map((track) => element("option", { value: track }, `track ${track}`));
        select.replaceChildren(...options, element("option", { value: -1 }, "new track"));
        listed = tracks.join();
      }
      select.value = String(now.track);
    });
    return select;
  }

  private loadSymmetries(object: number): void {
    this.symmetryIndex = 0;
    if (this.symmetriesOf === object) return;
    this.symmetriesOf = object;
    this.symmetries = [];
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
    if (this.symmetries.length === 0) return;
    this.annotator.applySymmetry(nextSymmetryStep(this.symmetries, this.symmetryIndex));
    this.symmetryIndex = (this.symmetryIndex + 1) % (this.symmetries.length + 1);
  }

  private makeInterval(id: number): HTMLElement {
    const make = (label: string, key: "first_view" | "last_view") => {
      const max = this.annotator.app.scene.views.length;
      const input = element("input", { type: "number", min: 1, max, "aria-label": label });
      input.addEventListener("change", () => this.annotator.setViews(id, { [key]: input.valueAsNumber - 1 }));
      this.fill.push((now) => setValue(input, String(now[key] + 1)));
      return input;
    };
    const [first, last] = [make("First view", "first_view"), make("Last view", "last_view")];
    return element("div", { class: "interval" }, "views ", first, " to ", last);
  }

  private makeNumbers(id: number, center: Vec3): HTMLElement {
    const inputs = kNumberNames.map((name, index) => {
      const input = element("input", { type: "number", step: index < 3 ? 1 : 0.5, "aria-label": name });
      input.addEventListener("change", () => this.annotator.setNumber(id, index, input.valueAsNumber));
      return input;
    });
    this.fill.push((now) => {
      const numbers = toNumbers(now.pose, center);
      inputs.forEach((input, index) => {
        setValue(input, (numbers[index] ?? 0).toFixed(2));
      });
    });
    const labels = inputs.map((input, index) => element("label", {}, kNumberNames[index] ?? "", input));
    return element("div", { class: "numbers" }, ...labels);
  }

  private makeResiduals(placement: Placement): HTMLElement {
    const { residuals, residualsOf } = this.annotator;
    if (!residualsOf || !isSamePose(residualsOf, placement.pose))
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
  private startPlacing(object: number): void {
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
