// SPDX-License-Identifier: Apache-2.0
// Everything that is known of the selected object, in numbers; without a selection, what happened in the run.
import type { Api } from "./api";
import { button, coordinates, element, metres, percent, type Row, table } from "./dom";
import { distance, rotationAngleDeg, translationOf } from "./geometry";
import { isChange, kEventMarks, kEventNames } from "./history";
import type { Detection, DetectionDetails, ObjectEvent, Pose, SceneObject, ViewDetails } from "./protocol";
import type { App } from "./store";
import { centerOf, viewNumber } from "./trace";
import { Why } from "./why";

const heading = (text: string, color?: string): HTMLElement =>
  element("h2", color ? { style: `--object-color: ${color}`, class: "object" } : {}, text);

export class Inspector {
  private details: ViewDetails | null = null;
  private wanted = "";
  private readonly why: Why;
  onError: (error: unknown) => void = () => {};

  constructor(
    private readonly root: HTMLElement,
    private readonly app: App,
    private readonly api: Api,
  ) {
    this.why = new Why(app, api);
    this.why.onLoad = () => this.show();
    this.why.onError = (error) => this.onError(error);
    app.listen((changed) => {
      if (changed.has("view") || changed.has("run")) this.load();
      else if (
        ["track", "object", "point", "event", "measured", "compare", "hypothesis"].some((key) =>
          changed.has(key as "track"),
        )
      )
        this.show();
    });
    this.load();
  }

  /** Details of the view; they are shown when they are there. */
  private load(): void {
    this.details = null;
    this.why.load();
    const { view, run } = this.app.get();
    this.show();
    if (this.app.scene.views.length === 0) return;
    this.wanted = `${view}/${run}`;
    const wanted = this.wanted;
    this.api.view(view, this.app.run() ? run : -1).then((details) => {
      if (this.wanted !== wanted) return;
      this.details = details;
      this.show();
    }, this.onError);
  }

  private show(): void {
    const { track, object, measured, point } = this.app.get();
    const parts: Node[] = [];
    if (measured.length > 0) parts.push(...this.showMeasured());
    else if (point)
      parts.push(heading("Place"), table([["position", coordinates(point)]]), ...this.why.showPlace(point));
    if (track >= 0) parts.push(...this.showTrack(track));
    else if (object >= 0) parts.push(...this.showObject(object));
    else parts.push(...this.showOverview());
    this.root.replaceChildren(...parts);
  }

  private showMeasured(): Node[] {
    const [a, b] = this.app.get().measured;
    if (!a) return [];
    const rows: Row[] = [["from", coordinates(a)]];
    if (b) rows.push(["to", coordinates(b)], ["distance", metres(distance(a, b))]);
    else rows.push(["to", "click a second place"]);
    return [heading("Distance"), table(rows)];
  }

  private showTrack(track: number): Node[] {
    const known = this.app.tracks().find((each) => each.track === track);
    const object = known ? this.app.object(known.object) : undefined;
    if (!known || !object) return [element("p", {}, `Track ${track} is not in this run.`)];
    const detection = this.app.selectedDetection();
    const rows: Row[] = [["track", String(track)]];
    if (object.obj_id > 0) rows.push(["obj_id", String(object.obj_id)]);
    if (!detection) rows.push(["this view", "not detected"]);
    const parts: Node[] = [heading(object.name, object.color), table(rows)];
    if (detection) parts.push(...this.showDetection(detection));
    parts.push(
      ...(detection
        ? this.why.showPlace(this.why.centerOf(known.object, detection.pose))
        : this.why.showObject(known.object)),
    );
    parts.push(element("h3", {}, "History"), this.eventList(known.events, false));
    return parts;
  }

  private showDetection(detection: Detection): Node[] {
    const index = this.app.runView()?.detections.indexOf(detection) ?? -1;
    const details = this.details?.detections[index];
    const rows: Row[] = [
      ["score", detection.score.toFixed(3)],
      ["fit", percent(detection.fit)],
      ["visible", percent(detection.visible_share)],
      ["position", coordinates(translationOf(detection.pose))],
    ];
    if (detection.verdict) rows.push(["verdict", detection.verdict]);
    const error = details?.truth_error;
    if (error) rows.push(["to ground truth", difference(error.center_distance_m, error.rotation_rad)]);
    const other = this.otherRun(detection);
    if (other) rows.push(other);
    if (details?.covariance) rows.push(...uncertaintyRows(details.covariance));
    const copy = button("Copy pose", "Copy the pose as a 4x4 matrix, row by row", () => {
      navigator.clipboard?.writeText(formatMatrix(detection.pose)).catch(this.onError);
    });
    return [table(rows), copy, ...(details ? evidenceTable(details) : [])];
  }

  private otherRun(detection: Detection): Row | null {
    const { compare } = this.app.get();
    const run = this.app.run(compare);
    if (!run) return null;
    const object = this.app.object(detection.object);
    const offset = (other: Detection) => centerDistance(object, other.pose, detection.pose);
    const nearest = (this.app.runView(compare)?.detections ?? [])
      .filter((other) => other.object === detection.object)
      .sort((a, b) => offset(a) - offset(b))[0];
    if (!nearest) return [`in ${run.name}`, "not detected"];
    // The angle of a symmetric object says nothing without its symmetries, which the page does not know.
    const angle = object?.num_symmetries ? null : (rotationAngleDeg(nearest.pose, detection.pose) * Math.PI) / 180;
    return [`in ${run.name}`, `score ${nearest.score.toFixed(3)}, ${difference(offset(nearest), angle)} away`];
  }

  private showObject(number: number): Node[] {
    const object = this.app.object(number);
    if (!object) return [];
    const truth = (this.details?.truth ?? []).filter((each) => each.object === number);
    const rows = objectRows(object);
    for (const each of truth)
      rows.push(["true position", coordinates(translationOf(each.pose))], ["visible", percent(each.visible_share)]);
    const parts = [heading(object.name, object.color), table(rows), ...this.why.showObject(number)];
    if (this.app.scene.views.length > 0) return parts;
    return [...parts, button("All models", "Show all models (Esc)", () => this.app.selectNothing())];
  }

  private showOverview(): Node[] {
    const run = this.app.run();
    if (run) return this.showRun();
    if (this.app.scene.views.length === 0) return this.showModels();
    const parts: Node[] = [heading(this.app.scene.title)];
    const truth = this.details?.truth ?? [];
    if (truth.length > 0) {
      const list = element("ul", { class: "events" });
      for (const each of truth)
        list.append(
          element(
            "li",
            {},
            button(each.name, `Select ${each.name}`, () => this.app.selectObject(each.object)),
          ),
        );
      parts.push(element("h3", {}, "True objects in this view"), list);
    }
    parts.push(element("p", { class: "hint" }, "Click a place in the image or in 3D to see where it is."));
    return parts;
  }

  private showRun(): Node[] {
    const run = this.app.run();
    const view = this.app.runView();
    if (!run) return [];
    const rows: Row[] = [["preset", run.preset]];
    if (view) {
      rows.push(["objects", String(view.detections.length)]);
      rows.push(["changed", percent(view.changed_share)]);
      if (view.pose_suspect) rows.push(["camera pose", "suspect: no change was reported"]);
    }
    const changes = this.app.changes();
    const parts: Node[] = [heading(run.name), table(rows), ...this.why.showMissed()];
    parts.push(element("h3", {}, `Changes (${changes.length})`));
    parts.push(
      changes.length > 0 ? this.eventList(changes, true) : element("p", { class: "hint" }, "Nothing changed."),
    );
    return parts;
  }

  private showModels(): Node[] {
    const filter = element("input", { type: "search", placeholder: "Find an object", "aria-label": "Find an object" });
    const list = element("ul", { class: "events" });
    const fill = () => {
      list.replaceChildren();
      this.app.scene.objects.forEach((object, number) => {
        if (!object.name.toLowerCase().includes(filter.value.toLowerCase())) return;
        const choose = button(object.name, `Select ${object.name}`, () => this.app.selectObject(number), {
          class: "object",
          style: `--object-color: ${object.color}`,
        });
        list.append(element("li", {}, choose));
      });
    };
    filter.addEventListener("input", fill);
    fill();
    return [heading(`${this.app.scene.objects.length} models`), filter, list];
  }

  private eventList(events: ObjectEvent[], withName: boolean): HTMLElement {
    const list = element("ul", { class: "events" });
    for (const { event, last } of joinRepeated(events)) {
      const name = withName ? `${this.app.object(event.object)?.name ?? "?"} ` : "";
      const object = this.app.object(event.object);
      const distanceM = event.before && event.after ? centerDistance(object, event.before, event.after) : 0;
      const by = event.kind === "moved" ? ` by ${metres(distanceM)}` : "";
      const text = `${name}${kEventNames[event.kind]}${by}`;
      const choose = button("", `${text}, view ${event.view + 1}`, () => this.app.selectEvent(event), {
        class: event === this.app.get().event ? "selected" : undefined,
      });
      choose.append(
        element("span", { class: `sign ${event.kind}` }, kEventMarks[event.kind]),
        element("span", { class: "what" }, text),
        element(
          "span",
          { class: "where" },
          last > event.view ? `views ${event.view + 1}–${last + 1}` : `view ${event.view + 1}`,
        ),
      );
      list.append(element("li", {}, choose));
    }
    return list;
  }
}

/** Between the centres of an object at two poses: its origin may be anywhere. */
function centerDistance(object: SceneObject | undefined, a: Pose, b: Pose): number {
  return distance(centerOf({ pose: a }, object), centerOf({ pose: b }, object));
}

/** Of two poses, in words; without an angle where that is unknown. */
function difference(distanceM: number, angleRad: number | null): string {
  return angleRad === null ? metres(distanceM) : `${metres(distanceM)}, ${((angleRad * 180) / Math.PI).toFixed(1)}°`;
}

/** Joins what is the same in one view after the other, such as "still there". */
function joinRepeated(events: ObjectEvent[]): { event: ObjectEvent; last: number }[] {
  const joined: { event: ObjectEvent; last: number }[] = [];
  for (const event of events) {
    const previous = joined.at(-1);
    const isSame = previous?.event.kind === event.kind && previous.event.track === event.track;
    if (previous && isSame && !isChange(event.kind)) previous.last = event.view;
    else joined.push({ event, last: event.view });
  }
  return joined;
}

function objectRows(object: SceneObject): Row[] {
  const rows: Row[] = [];
  if (object.obj_id > 0) rows.push(["obj_id", String(object.obj_id)]);
  if (object.diameter_m) rows.push(["diameter", metres(object.diameter_m)]);
  if (object.num_points !== undefined) rows.push(["surface", `${object.num_points.toLocaleString("en")} points`]);
  if (object.num_sift !== undefined) rows.push(["SIFT, SHOT", `${object.num_sift}, ${object.num_shot ?? 0} keypoints`]);
  if (object.num_symmetries) rows.push(["symmetries", String(object.num_symmetries)]);
  if (!object.has_surface) rows.push(["surface", "unknown (no model is loaded)"]);
  return rows;
}

/** Standard deviations of a covariance of rotation and translation. */
function uncertaintyRows(covariance: number[]): Row[] {
  const deviation = (i: number) => Math.sqrt(Math.max(0, covariance[7 * i] ?? 0));
  const degrees = [0, 1, 2].map((i) => ((deviation(i) * 180) / Math.PI).toFixed(2));
  const millimetres = [3, 4, 5].map((i) => (1000 * deviation(i)).toFixed(1));
  return [
    ["σ position", `${millimetres.join(", ")} mm`],
    ["σ rotation", `${degrees.join(", ")}°`],
    ["ellipsoid", "3 σ of the centre, 10 times enlarged"],
  ];
}

function evidenceTable(details: DetectionDetails): Node[] {
  if (details.evidence.length === 0) return [];
  const head = element(
    "tr",
    {},
    ...["view", "visible", "explained", ""].map((name) => element("th", { scope: "col" }, name)),
  );
  const rows = details.evidence.map((each) => {
    const name = viewNumber(each.view);
    const note = each.allowed ? "" : "excluded by changes";
    return element(
      "tr",
      {},
      ...[name, percent(each.visible_share), percent(each.explained_share), note].map((text) =>
        element("td", {}, text),
      ),
    );
  });
  return [
    element("h3", {}, "Evidence by view"),
    element("table", {}, element("thead", {}, head), element("tbody", {}, ...rows)),
  ];
}

function formatMatrix(pose: number[]): string {
  const rows = [0, 1, 2, 3].map((r) => [0, 1, 2, 3].map((c) => String(pose[r + 4 * c] ?? 0)).join(" "));
  return `${rows.join("\n")}\n`;
}
