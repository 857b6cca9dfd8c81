// SPDX-License-Identifier: Apache-2.0
// Fetches data from the server and keeps what was used last. Data are made once on both sides.
import { type Action, type Annotation, isIn, type Placement, type RegionPixels } from "./annotation";
import type { Camera, Cloud, DetectionDetails, Scene, ViewDetails } from "./protocol";
import { decodeCloud } from "./protocol";
import type { Trace } from "./trace";

const kMaxViews = 24;
const kMinViews = 3;
const kMaxImageBytes = 256 * 2 ** 20;
const kBytesPerPixel = 12; // a bitmap, its pixels and depth: see ViewImages
const kMaxDetails = 300;

/** Keeps promises of the values that were used last; failures are not kept. */
export class Recent<T> {
  private readonly values = new Map<string, Promise<T>>();
  constructor(
    public maxCount: number,
    private readonly drop: (value: T) => void = () => {},
  ) {}

  get(key: string, make: () => Promise<T>): Promise<T> {
    const known = this.values.get(key);
    if (known) {
      this.values.delete(key);
      this.values.set(key, known);
      return known;
    }
    const made = make();
    this.values.set(key, made);
    made.catch(() => this.values.delete(key));
    while (this.values.size > this.maxCount) {
      const [oldest] = this.values;
      if (!oldest) break;
      this.values.delete(oldest[0]);
      oldest[1].then(this.drop, () => {});
    }
    return made;
  }
  clear(): void {
    this.values.clear();
  }
}

/** How many views are kept: as many as fit into the memory, within limits. */
export function numKeptViews({ width, height }: Camera): number {
  const fitting = Math.floor(kMaxImageBytes / (kBytesPerPixel * width * height));
  return Math.max(kMinViews, Math.min(kMaxViews, fitting));
}

/** The details of the placements of a view in the order in which the page knows these. The server may know others by
 * now: another window has edited them. */
export function inOrder(known: readonly Placement[], answered: readonly DetectionDetails[]): DetectionDetails[] {
  const none: DetectionDetails = { outline: [], covariance: null, evidence: [] };
  return known.map(({ id }) => answered.find((each) => each.id === id) ?? none);
}

/** The data of the whole events in a text of server-sent events, and what follows them. */
export function splitEvents(text: string): { data: string[]; rest: string } {
  const events = text.split("\n\n");
  const rest = events.pop() ?? "";
  const data = events.filter((event) => event.startsWith("data: ")).map((event) => event.slice("data: ".length));
  return { data, rest };
}

/** An answer other than success. */
export class StatusError extends Error {
  constructor(
    readonly status: number,
    message: string,
  ) {
    super(message);
  }
}

/** The images of a view. */
export interface ViewImages {
  bitmap: ImageBitmap;
  /** Red, green, blue and alpha of each pixel. */
  pixels: Uint8ClampedArray;
  depth: Float32Array;
}

export class Api {
  private readonly images = new Recent<ViewImages>(kMaxViews);
  private readonly details = new Recent<ViewDetails>(kMaxDetails);
  private readonly traces = new Recent<Trace>(kMaxDetails);
  private readonly clouds = new Recent<Cloud>(kMaxViews);
  private readonly surfaces = new Recent<Cloud>(1000);

  /** Views are those of the annotation. */
  isAnnotated = false;
  /** Those of the annotation that was received last. */
  private placements: readonly Placement[] = [];

  constructor(private readonly token: string) {}

  private async ask(path: string, body?: unknown): Promise<Response> {
    let response: Response;
    const headers = { "X-Resight-Token": this.token, "Content-Type": "application/json" };
    const request = body === undefined ? { headers } : { headers, method: "POST", body: JSON.stringify(body) };
    try {
      response = await fetch(path, request);
    } catch {
      throw new Error("resight does not answer; has it been stopped?");
    }
    if (!response.ok) throw new StatusError(response.status, await response.text());
    return response;
  }

  async scene(): Promise<Scene> {
    return (await this.ask("/api/scene")).json();
  }
  async annotation(): Promise<Annotation> {
    return this.keep(await (await this.ask("/api/annotation")).json());
  }
  async act(revision: number, action: Action): Promise<Annotation> {
    return this.keep(await (await this.ask("/api/annotation/actions", { revision, action })).json());
  }
  private keep(annotation: Annotation): Annotation {
    this.placements = annotation.objects;
    return annotation;
  }
  /** Asks for something that changes nothing but takes work (docs/annotate.md). */
  async post<T>(what: "place" | "refine" | "assess" | "export", body: unknown): Promise<T> {
    return (await this.ask(`/api/annotation/${what}`, body)).json();
  }
  async symmetries(object: number): Promise<number[][]> {
    return (await this.ask(`/api/annotation/symmetries/${object}`)).json();
  }
  async regionPixels(region: number): Promise<RegionPixels> {
    return (await this.ask(`/api/annotation/regions/${region}`)).json();
  }
  /** The revision of the scene, at once and whenever it changes, until the server ends the stream. */
  async *revisions(): AsyncGenerator<number> {
    const reader = (await this.ask("/api/events")).body?.getReader();
    if (!reader) return;
    const decoder = new TextDecoder();
    let text = "";
    try {
      for (let part = await reader.read(); !part.done; part = await reader.read()) {
        const { data, rest } = splitEvents(text + decoder.decode(part.value, { stream: true }));
        text = rest;
        for (const each of data) yield Number(each);
      }
    } finally {
      await reader.cancel().catch(() => {}); // of a stream that has failed, its own error counts
    }
  }
  view(view: number, run: number): Promise<ViewDetails> {
    return this.details.get(`${view}/${run}`, async () => {
      if (this.isAnnotated) return this.annotatedView(view);
      const query = run >= 0 ? `?run=${run}` : "";
      return (await this.ask(`/api/views/${view}${query}`)).json();
    });
  }
  private async annotatedView(view: number): Promise<ViewDetails> {
    const details: ViewDetails = await (await this.ask(`/api/annotation/views/${view}`)).json();
    const known = this.placements.filter((each) => isIn(each, view));
    return { ...details, detections: inOrder(known, details.detections) };
  }
  /** What became of the hypotheses of a view, in a run with has_trace. */
  trace(view: number, run: number): Promise<Trace> {
    return this.traces.get(`${view}/${run}`, async () =>
      (await this.ask(`/api/views/${view}/trace?run=${run}`)).json(),
    );
  }
  viewImages(view: number, camera: Camera): Promise<ViewImages> {
    this.images.maxCount = numKeptViews(camera);
    return this.images.get(String(view), async () => {
      const [color, depth] = await Promise.all([
        this.ask(`/api/views/${view}/color`).then((response) => response.blob()),
        this.ask(`/api/views/${view}/depth`).then((response) => response.arrayBuffer()),
      ]);
      const bitmap = await createImageBitmap(color);
      const values = new Float32Array(depth);
      if (values.length !== camera.width * camera.height) throw new Error("the depth of a view is cut off");
      return { bitmap, pixels: readPixels(bitmap), depth: values };
    });
  }
  surface(object: number): Promise<Cloud> {
    return this.surfaces.get(String(object), async () =>
      decodeCloud(await (await this.ask(`/api/surfaces/${object}`)).arrayBuffer()),
    );
  }
  /** Reconstruction at a view, removed points red, novel ones green. */
  changes(view: number): Promise<Cloud> {
    return this.clouds.get(String(view), async () =>
      decodeCloud(await (await this.ask(`/api/views/${view}/changes`)).arrayBuffer()),
    );
  }
  /** Forgets what depends on results, which have changed. */
  forgetDetails(): void {
    this.details.clear();
    this.traces.clear();
  }
}

function readPixels(bitmap: ImageBitmap): Uint8ClampedArray {
  const canvas = new OffscreenCanvas(bitmap.width, bitmap.height);
  const context = canvas.getContext("2d", { willReadFrequently: true });
  if (!context) throw new Error("this browser has no 2D canvas");
  context.drawImage(bitmap, 0, 0);
  return context.getImageData(0, 0, bitmap.width, bitmap.height).data;
}
