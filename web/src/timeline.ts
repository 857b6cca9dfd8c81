// SPDX-License-Identifier: Apache-2.0
// Views from left to right: where each object was detected, and what happened to it. Moves to a view, an event or an
// object by a click.
import { button, element, percent } from "./dom";
import { isChange, kEventMarks, kEventNames, neighbourChange, type Track } from "./history";
import type { ObjectEvent } from "./protocol";
import type { App } from "./store";

const kPlayIntervalMs = 500;
const kMarkRadiusPx = 9; // as in viewer.css
const kMarkStepPx = 16;

export class Timeline {
  private readonly slider: HTMLInputElement;
  private readonly play: HTMLButtonElement;
  private readonly rows: HTMLElement;
  private readonly cursor: HTMLElement;
  private timer = 0;

  constructor(
    private readonly root: HTMLElement,
    private readonly app: App,
  ) {
    const step = (offset: number) => () => app.goTo(app.get().view + offset);
    this.play = button("▶", "Play (Space)", () => app.togglePlaying());
    this.slider = element("input", { type: "range", min: 0, step: 1, "aria-label": "View" });
    this.slider.addEventListener("input", () => app.goTo(Number(this.slider.value)));
    this.cursor = element("div", { class: "cursor" });
    this.rows = element("div", { class: "rows" });
    root.append(
      element(
        "div",
        { class: "transport" },
        ...(app.scene.runs.length > 0 ? [button("«", "Previous change (P)", () => this.goToChange(-1))] : []),
        button("‹", "Previous view (Left)", step(-1)),
        this.play,
        button("›", "Next view (Right)", step(1)),
        ...(app.scene.runs.length > 0 ? [button("»", "Next change (N)", () => this.goToChange(1))] : []),
      ),
      element("div", { class: "scrubber" }, this.slider),
      this.rows,
    );
    app.listen((changed) => this.onChange(changed));
    this.rebuild();
  }

  goToChange(direction: 1 | -1): void {
    const { view, event } = this.app.get();
    const next = neighbourChange(this.app.changes(), view, event, direction);
    if (next) this.app.selectEvent(next);
  }

  private onChange(changed: Set<string>): void {
    if (changed.has("run") || changed.has("edit")) this.rebuild();
    if (changed.has("shownView")) this.playOn();
    if (changed.has("isPlaying")) this.setPlaying(this.app.get().isPlaying);
    if (changed.has("view")) this.showView();
    if (changed.has("track") || changed.has("event")) this.showSelection();
  }

  private setPlaying(isPlaying: boolean): void {
    window.clearTimeout(this.timer);
    this.play.textContent = isPlaying ? "❚❚" : "▶";
    this.play.title = isPlaying ? "Pause (Space)" : "Play (Space)";
    this.play.setAttribute("aria-label", this.play.title);
    if (!isPlaying) return;
    if (this.app.get().view === this.app.scene.views.length - 1) this.app.goTo(0);
    else this.playOn();
  }

  /** Shows the next view after a while; a view that is still loading is waited for. */
  private playOn(): void {
    window.clearTimeout(this.timer);
    const { isPlaying, shownView, view } = this.app.get();
    if (!isPlaying || shownView !== view) return;
    this.timer = window.setTimeout(() => {
      if (this.app.get().view >= this.app.scene.views.length - 1) this.app.set({ isPlaying: false });
      else this.app.goTo(this.app.get().view + 1);
    }, kPlayIntervalMs);
  }

  /** Share of the width at which a view begins. */
  private left(view: number): string {
    return `${((100 * view) / this.app.scene.views.length).toFixed(3)}%`;
  }

  private rebuild(): void {
    this.root.style.setProperty("--count", String(this.app.scene.views.length));
    this.slider.max = String(this.app.scene.views.length - 1);
    const rows = this.app.tracks().map((track) => this.makeRow(track));
    const summary = this.app.changes().length > 0 ? [this.makeSummary()] : [];
    this.rows.replaceChildren(...summary, ...rows, this.cursor);
    this.rows.classList.toggle("empty", this.app.tracks().length === 0);
    this.showView();
    this.showSelection();
  }

  private makeRow(track: Track): HTMLElement {
    const object = this.app.object(track.object);
    const name = object?.name ?? "?";
    const label = button(name, `Select ${name}, track ${track.track}`, () => this.app.selectTrack(track.track), {
      class: "name",
      style: `--object-color: ${object?.color ?? "#888"}`,
    });
    const lane = element("div", { class: "lane", style: `--object-color: ${object?.color ?? "#888"}` });
    for (const span of track.spans) {
      const width = ((100 * (span.last - span.first + 1)) / this.app.scene.views.length).toFixed(3);
      lane.append(element("div", { class: "span", style: `left: ${this.left(span.first)}; width: ${width}%` }));
    }
    for (const event of track.events) if (isChange(event.kind)) lane.append(this.makeMark(event, name));
    lane.addEventListener("click", (event) => {
      if (event.target instanceof HTMLButtonElement) return;
      const box = lane.getBoundingClientRect();
      const view = Math.floor(((event.clientX - box.left) / box.width) * this.app.scene.views.length);
      this.app.selectTrack(track.track);
      this.app.goTo(view);
    });
    return element("div", { class: "row", "data-track": track.track }, label, lane);
  }

  /** All changes in one row, which stays on top. */
  private makeSummary(): HTMLElement {
    const lane = element("div", { class: "lane" });
    const numInView = new Map<number, number>();
    for (const event of this.app.changes()) {
      const mark = this.makeMark(event, this.app.object(event.object)?.name ?? "?");
      const index = numInView.get(event.view) ?? 0;
      numInView.set(event.view, index + 1);
      mark.style.marginLeft = `${kMarkStepPx * index - kMarkRadiusPx}px`; // side by side, not one upon the other
      lane.append(mark);
    }
    return element("div", { class: "row summary" }, element("span", { class: "name" }, "all changes"), lane);
  }

  private makeMark(event: ObjectEvent, name: string): HTMLButtonElement {
    const text = `${name} ${kEventNames[event.kind]} at view ${event.view + 1}, confidence ${percent(event.confidence)}`;
    const mark = button(kEventMarks[event.kind], text, () => this.app.selectEvent(event), {
      class: `mark ${event.kind}`,
      style: `left: ${this.left(event.view + 0.5)}`,
    });
    mark.dataset.event = String(this.app.run()?.events.indexOf(event) ?? -1);
    return mark;
  }

  private showView(): void {
    const { view } = this.app.get();
    this.slider.value = String(view);
    this.slider.setAttribute("aria-valuetext", `view ${view + 1} of ${this.app.scene.views.length}`);
    this.cursor.style.setProperty("--view", String(view));
  }

  private showSelection(): void {
    const { track, event } = this.app.get();
    const index = event ? (this.app.run()?.events.indexOf(event) ?? -1) : -1;
    for (const row of this.rows.querySelectorAll<HTMLElement>(".row")) {
      const isSelected = Number(row.dataset.track) === track && track >= 0;
      row.classList.toggle("selected", isSelected);
      if (isSelected) row.scrollIntoView({ block: "nearest" });
    }
    for (const mark of this.rows.querySelectorAll<HTMLElement>(".mark"))
      mark.classList.toggle("selected", index >= 0 && Number(mark.dataset.event) === index);
  }
}
