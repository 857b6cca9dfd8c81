// SPDX-License-Identifier: Apache-2.0
// Corrects the mask of a region in the image, by brush or by lasso. Each stroke is one edit, so that it can be undone.
import type { Annotator } from "./annotator";
import type { Api } from "./api";
import { button, element } from "./dom";
import type { ImagePanel } from "./image_panel";
import { PixelMask, type Point } from "./mask";

const kColor = [255, 212, 0, 120] as const;
const kMaxRadiusPx = 40;

export class MaskEditor {
  /** Number of the region; -1: none is edited. */
  region = -1;
  private mask: PixelMask | null = null;
  private picture: HTMLCanvasElement | null = null;
  private tool: "brush" | "lasso" = "brush";
  private adds = true;
  private radius = 6;
  private stroke: Point[] = [];
  private numUnsent = 0;
  private numLoads = 0;
  /** Called when another region is edited, or another tool is used. */
  onChange: () => void = () => {};

  constructor(
    private readonly annotator: Annotator,
    private readonly api: Api,
    private readonly panel: ImagePanel,
  ) {
    panel.overlay = (context, pixel) => this.drawOn(context, pixel);
    annotator.app.listen((changed) => {
      if (this.region < 0) return;
      if (changed.has("edit")) this.load();
      else if (changed.has("view") && annotator.annotation.regions[this.region]?.view !== annotator.app.get().view)
        this.end();
    });
  }

  /** Starts, in the view of the region. */
  begin(region: number): void {
    const found = this.annotator.annotation.regions[region];
    if (!found) return;
    this.annotator.app.goTo(found.view);
    this.region = region;
    this.clear(); // no stroke may go from the mask of another region to this one
    this.panel.tool = {
      press: (at) => this.onPress(at),
      drag: (at) => this.onDrag(at),
      release: () => this.onRelease(),
    };
    this.load();
    this.onChange();
  }
  end(): void {
    this.region = -1;
    this.clear();
    this.panel.tool = null;
    this.onChange();
  }
  private clear(): void {
    this.mask = null;
    this.picture = null;
    this.stroke = [];
    this.panel.draw();
  }

  /** The page has strokes that the server does not have yet. */
  private isAhead(): boolean {
    return this.stroke.length > 0 || this.numUnsent > 0;
  }
  /** Takes the mask of the server. While strokes are on their way, it is older than what is shown. */
  private load(): void {
    const { region } = this;
    if (region < 0 || this.isAhead()) return;
    const number = ++this.numLoads;
    const { view } = this.annotator.app.get();
    Promise.all([this.api.regionPixels(region), this.api.view(view, 0)]).then(
      ([{ proposed, corrected }, { camera }]) => {
        if (this.region !== region || this.numLoads !== number || this.isAhead()) return;
        this.mask = new PixelMask(camera.width, camera.height, corrected ?? proposed);
        this.draw();
      },
      (error) => this.annotator.say(error instanceof Error ? error.message : String(error), true),
    );
  }

  private onPress(at: Point): void {
    if (!this.mask) return; // it is loading
    this.stroke = [at];
    if (this.tool === "brush") this.paint(at, at);
  }
  private onDrag(at: Point): void {
    const last = this.stroke.at(-1);
    if (!last) return;
    this.stroke.push(at);
    if (this.tool === "brush") this.paint(last, at);
    else this.panel.draw();
  }
  private onRelease(): void {
    const { stroke, mask } = this;
    if (!mask || stroke.length === 0) return;
    this.stroke = [];
    if (this.tool === "lasso") {
      mask.fillPolygon(stroke, this.adds ? 1 : 0);
      this.draw();
    }
    this.send(mask);
  }
  private async send(mask: PixelMask): Promise<void> {
    ++this.numUnsent;
    await this.annotator.correctMask(this.region, mask.toRuns());
    --this.numUnsent;
    this.load();
  }
  private paint(from: Point, to: Point): void {
    this.mask?.paintLine(from, to, this.radius, this.adds ? 1 : 0);
    this.draw();
  }

  private draw(): void {
    const { mask } = this;
    if (!mask) return;
    const picture = this.picture ?? element("canvas", { width: mask.width, height: mask.height });
    this.picture = picture;
    const context = picture.getContext("2d");
    if (!context) return;
    const image = context.createImageData(mask.width, mask.height);
    mask.data.forEach((value, pixel) => {
      if (value > 0) image.data.set(kColor, 4 * pixel);
    });
    context.putImageData(image, 0, 0);
    this.panel.draw();
  }

  private drawOn(context: CanvasRenderingContext2D, pixel: number): void {
    if (this.region < 0) return;
    if (this.picture) context.drawImage(this.picture, 0, 0);
    if (this.tool !== "lasso" || this.stroke.length < 2) return;
    context.beginPath();
    for (const [u, v] of this.stroke) context.lineTo(u + 0.5, v + 0.5);
    context.closePath();
    context.strokeStyle = "#ffd400";
    context.lineWidth = 1.5 * pixel;
    context.stroke();
  }

  /** The controls, while a mask is corrected. */
  controls(): HTMLElement[] {
    const found = this.annotator.annotation.regions[this.region];
    if (!found) return [];
    const toggle = (label: string, title: string, isOn: boolean, change: () => void) =>
      button(
        label,
        title,
        () => {
          change();
          this.onChange();
        },
        { "aria-pressed": String(isOn) },
      );
    const set = (tool: "brush" | "lasso", adds: boolean) => () => {
      this.tool = tool;
      this.adds = adds;
    };
    const is = (tool: "brush" | "lasso", adds: boolean) => this.tool === tool && this.adds === adds;
    const size = element("input", {
      type: "range",
      min: 1,
      max: kMaxRadiusPx,
      value: this.radius,
      "aria-label": "Radius of the brush in pixels",
      title: "Radius of the brush",
    });
    size.addEventListener("input", () => {
      this.radius = size.valueAsNumber;
    });
    return [
      element("h2", {}, `Mask of what ${found.kind === "novel" ? "came" : "left"} before view ${found.view + 1}`),
      element(
        "div",
        { class: "tools" },
        toggle("Brush +", "Add what the brush touches", is("brush", true), set("brush", true)),
        toggle("Brush −", "Remove what the brush touches", is("brush", false), set("brush", false)),
        toggle("Lasso +", "Add what is drawn around", is("lasso", true), set("lasso", true)),
        toggle("Lasso −", "Remove what is drawn around", is("lasso", false), set("lasso", false)),
        size,
        button(
          "As proposed",
          "Take the mask of the change detector",
          () => this.annotator.correctMask(this.region, null),
          {
            disabled: !found.is_corrected,
          },
        ),
        button("Done", "End the correction (Escape)", () => this.end()),
      ),
    ];
  }
}
