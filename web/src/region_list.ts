// SPDX-License-Identifier: Apache-2.0
// What is open, and what was said of the regions that came or left and of things without model.
import type { Region, ToDo } from "./annotation";
import type { Annotator } from "./annotator";
import { button, element } from "./dom";
import type { Vec3 } from "./geometry";

const kMaxToDos = 60;

export class RegionList {
  private readonly list = element("div", { class: "to-dos" });
  private readonly unknownName = element("input", {
    value: "unknown",
    maxlength: 60,
    "aria-label": "Name of things without model",
    title: "Name of things without model, for Unknown and Moved",
  });
  /** The region that is one side of a move of an unknown thing; -1: none is chosen. */
  private moved = -1;
  onCorrect: (region: number) => void = () => {};

  constructor(private readonly annotator: Annotator) {}

  parts(): HTMLElement[] {
    return [element("h2", {}, "To do"), this.unknownName, this.list];
  }

  show(): void {
    const { to_dos, unknown_events, regions } = this.annotator.annotation;
    if (this.moved >= regions.length) this.moved = -1;
    const rows = to_dos.slice(0, kMaxToDos).map((toDo) => this.makeToDo(toDo));
    if (to_dos.length > kMaxToDos) rows.push(element("p", {}, `… and ${to_dos.length - kMaxToDos} more`));
    const events = unknown_events.map((event) =>
      this.makeRow(`view ${event.view + 1}: ${event.name} ${event.kind}`, event.view, null, [
        button("Delete", "Delete the event", () => this.annotator.dropEvent(event.id)),
      ]),
    );
    const decided = this.decidedRows(regions);
    this.unknownName.hidden = !to_dos.some((each) => each.region >= 0);
    if (rows.length === 0) rows.push(element("p", { class: "hint" }, "Nothing is open."));
    this.list.replaceChildren(...rows, ...events, ...decided);
  }

  /** The regions of the current view that were judged or corrected. */
  private decidedRows(regions: Region[]): HTMLElement[] {
    const { view } = this.annotator.app.get();
    const rows: HTMLElement[] = [];
    regions.forEach((region, index) => {
      if (region.view !== view || (region.verdict === "open" && !region.is_corrected)) return;
      const what = region.kind === "novel" ? "came" : "left";
      const name = this.annotator.nameOfTrack(region.track) || "what";
      const text = `${region.verdict}: ${name} ${what}${region.is_corrected ? ", mask corrected" : ""}`;
      const reopen = button("Reopen", "Take the decision back", () => this.annotator.judge(index, "open"), {
        disabled: region.verdict === "open",
      });
      rows.push(this.makeRow(text, view, region, [this.correctButton(index), reopen]));
    });
    return rows.length > 0 ? [element("h3", {}, "Regions of this view"), ...rows] : [];
  }

  private makeRow(text: string, view: number, region: Region | null, buttons: HTMLElement[]): HTMLElement {
    const go = button(text, `Show it: ${text}`, () => {
      this.annotator.app.goTo(view);
      if (region) this.annotator.app.set({ point: region.pose.slice(12, 15) as Vec3, track: -1 });
    });
    return element("div", { class: "to-do done" }, go, ...buttons);
  }

  private makeToDo(toDo: ToDo): HTMLElement {
    const { annotator } = this;
    const go = button(toDo.text, `Show it: ${toDo.text}`, () => {
      annotator.app.goTo(toDo.view);
      const region = annotator.annotation.regions[toDo.region];
      if (toDo.track >= 0) annotator.app.selectTrack(toDo.track);
      else if (region) annotator.app.set({ point: region.pose.slice(12, 15) as Vec3, track: -1 });
    });
    const row = element("div", { class: `to-do ${toDo.kind}` }, go);
    const { lost } = toDo;
    if (lost) row.append(button("Forget", "Forget the decision", () => annotator.forget(lost)));
    if (toDo.region < 0) return row;
    row.append(
      button("Unknown", "A thing without model came or left", () =>
        annotator.addUnknown(toDo.region, this.unknownName.value),
      ),
      this.moveButton(toDo.region),
      button("Accept", "A change of the selected object if it is at this place, else of none", () =>
        annotator.judge(toDo.region, "accepted", annotator.causeOf(toDo.region)),
      ),
      button("Reject", "Nothing has changed here", () => annotator.judge(toDo.region, "rejected")),
      this.correctButton(toDo.region),
    );
    return row;
  }

  private correctButton(region: number): HTMLElement {
    return button("Mask", "Correct its mask in the image, by brush or lasso", () => this.onCorrect(region));
  }
  /** The first press chooses one side of a move, the second one, at a region of the other kind, the other side. */
  private moveButton(region: number): HTMLElement {
    const isChosen = this.moved === region;
    return button(
      "Moved",
      "A thing without model moved: press it at the place it left and at the new one",
      () => this.chooseMoved(region),
      { "aria-pressed": String(isChosen) },
    );
  }
  private chooseMoved(region: number): void {
    const { regions } = this.annotator.annotation;
    const first = this.moved;
    this.moved = first === region ? -1 : region;
    if (first >= 0 && regions[first]?.kind !== regions[region]?.kind) {
      this.moved = -1;
      const name = this.unknownName.value;
      this.annotator.moveUnknown(first, region, name).then((isDone) => {
        if (isDone) this.annotator.say(`${name} has moved.`);
      });
      return;
    }
    const other = regions[region]?.kind === "novel" ? "left" : "came to";
    this.annotator.say(this.moved < 0 ? "" : `Press Moved at the place that it ${other}.`);
    this.show();
  }
}
