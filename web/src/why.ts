// SPDX-License-Identifier: Apache-2.0
// Why an object was found, or not: the hypotheses at a place with their evidence, and where a missed object was lost.
import type { Api } from "./api";
import { button, element, table } from "./dom";
import type { Vec3 } from "./geometry";
import type { App } from "./store";
import {
  centerOf,
  evidenceRows,
  explain,
  type Hypothesis,
  hypothesesAt,
  type Loss,
  lossRows,
  type Trace,
} from "./trace";

const kMaxShown = 15;

export class Why {
  private trace: Trace | null = null;
  private wanted = "";
  onError: (error: unknown) => void = () => {};
  /** Called when the trace of the view is there. */
  onLoad: () => void = () => {};

  constructor(
    private readonly app: App,
    private readonly api: Api,
  ) {}

  load(): void {
    const { view, run } = this.app.get();
    this.trace = null;
    this.wanted = `${view}/${run}`;
    if (!this.app.run()?.has_trace) return;
    const wanted = this.wanted;
    this.api.trace(view, run).then((trace) => {
      if (this.wanted !== wanted) return;
      this.trace = trace;
      this.onLoad();
    }, this.onError);
  }

  /** The hypotheses at a place. */
  showPlace(place: Vec3): Node[] {
    const { trace } = this;
    if (!trace) return [];
    return this.list("Why: hypotheses here", hypothesesAt(trace, place, this.app.scene.objects), trace);
  }

  /** Where the missed instances of an object were lost, and all its hypotheses. */
  showObject(object: number): Node[] {
    const { trace } = this;
    if (!trace) return [];
    const losses = trace.lost.filter((loss) => loss.object === object);
    const parts = losses.flatMap((loss) => [element("h3", {}, "Why it is missing"), table(lossRows(loss))]);
    const same = trace.hypotheses.filter((hypothesis) => hypothesis.object === object);
    return [...parts, ...this.list("Its hypotheses", same, trace)];
  }

  /** All objects that the view shows and the run missed. */
  showMissed(): Node[] {
    const lost = this.trace?.lost ?? [];
    if (lost.length === 0) return [];
    const list = element("ul", { class: "events" });
    for (const loss of lost) list.append(element("li", {}, this.missedButton(loss)));
    return [element("h3", {}, `Missed in this view (${lost.length})`), list];
  }
  private missedButton(loss: Loss): HTMLElement {
    const choose = button("", `${loss.name}, lost at: ${loss.stage}`, () => {
      this.app.selectObject(loss.object);
      this.app.set({ hypothesis: this.trace?.hypotheses[loss.hypothesis] ?? null });
    });
    choose.append(element("span", { class: "what" }, loss.name), element("span", { class: "where" }, loss.stage));
    return choose;
  }

  private list(title: string, hypotheses: Hypothesis[], trace: Trace): Node[] {
    const searched = trace.is_searched ? "" : " The view was not searched: it shows nothing new.";
    if (hypotheses.length === 0)
      return [element("h3", {}, title), element("p", { class: "hint" }, `There is none.${searched}`)];
    const list = element("ul", { class: "events why" });
    for (const hypothesis of hypotheses.slice(0, kMaxShown)) list.append(this.entry(hypothesis, trace));
    const more = hypotheses.length - kMaxShown;
    const rest = more > 0 ? [element("p", { class: "hint" }, `… and ${more} that fit worse`)] : [];
    return [element("h3", {}, `${title} (${hypotheses.length})`), list, ...rest];
  }

  private entry(hypothesis: Hypothesis, trace: Trace): HTMLElement {
    const isChosen = this.app.get().hypothesis === hypothesis;
    const why = explain(hypothesis, trace);
    const choose = button(
      "",
      `${hypothesis.name}, ${hypothesis.verdict}${why ? `: ${why}` : ""}`,
      () => this.app.set({ hypothesis: isChosen ? null : hypothesis }),
      { class: isChosen ? "selected" : undefined, "aria-expanded": String(isChosen) },
    );
    const isAccepted = hypothesis.verdict === "accepted";
    choose.append(
      element("span", { class: `sign ${isAccepted ? "added" : "removed"}` }, isAccepted ? "✓" : "✗"),
      element("span", { class: "what" }, hypothesis.name),
      element("span", { class: "where" }, hypothesis.verdict),
    );
    const item = element("li", {}, choose);
    if (why) item.append(element("p", { class: "reason" }, why));
    if (isChosen) item.append(table(evidenceRows(hypothesis)));
    return item;
  }

  /** The centre of an object at a pose. */
  centerOf(object: number, pose: number[]): Vec3 {
    return centerOf({ pose }, this.app.object(object));
  }
}
