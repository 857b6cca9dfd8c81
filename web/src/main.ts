// SPDX-License-Identifier: Apache-2.0
import { AnnotateKeys, mayRepeat } from "./annotate_keys";
import { AnnotatePanel } from "./annotate_panel";
import { isIn, type Placement, toRun } from "./annotation";
import { Annotator } from "./annotator";
import { Api } from "./api";
import { Bar, isDark, restoreTheme, toggleTheme } from "./bar";
import { byId, coordinates, download, element, metres } from "./dom";
import { distance, guessUp, inverseRigid, project, transformPoint, type Vec3 } from "./geometry";
import { ImagePanel, type PointedAt } from "./image_panel";
import { Inspector } from "./inspector";
import { formatLink, type LinkState, parseLink } from "./link";
import { follow } from "./live";
import { MaskEditor } from "./mask_editor";
import { makePicture } from "./picture";
import type { Pose } from "./protocol";
import { SceneView } from "./scene_view";
import { App } from "./store";
import { Timeline } from "./timeline";
import { makeBox, World } from "./world";

/** The whole page. */
class Viewer {
  private readonly world: World;
  private readonly sceneView: SceneView;
  private readonly panels: ImagePanel[] = [];
  private readonly bar: Bar;
  private readonly timeline: Timeline | null;
  private readonly status = byId("status");
  private readonly annotateKeys: AnnotateKeys | null = null;
  private linkTimer = 0;
  /** The fragment that this page was loaded with or has written last. */
  private fragment = location.hash;
  private hasHome = false;
  /** The view that was asked for last. */
  private asked: Promise<unknown> = Promise.resolve();

  constructor(
    private readonly app: App,
    private readonly api: Api,
    private readonly token: string,
    private readonly annotator: Annotator | null,
  ) {
    const { scene } = app;
    const hasViews = scene.views.length > 0;
    document.body.classList.toggle("models", !hasViews);
    document.title = `${scene.title} – resight`;
    const poses = scene.views.map((_, view) => app.cameraPose(view)).filter((pose): pose is Pose => pose !== null);
    this.world = new World(byId("world"), hasViews ? guessUp(poses) : [0, 0, 1]);
    this.sceneView = new SceneView(this.world, app, api);
    this.sceneView.onError = (error) => this.report(error);
    this.bar = new Bar(byId("bar"), app, {
      exportPicture: () => this.exportPicture(),
      copyLink: () => this.copyLink(),
      resetCamera: () => this.world.goHome(),
    });
    this.timeline = hasViews ? new Timeline(byId("timeline"), app) : null;
    if (hasViews) this.addPanels();
    if (annotator) {
      this.annotateKeys = this.startAnnotating(annotator);
    } else {
      const inspector = new Inspector(byId("inspector"), app, api);
      inspector.onError = (error) => this.report(error);
    }
    this.listenToPointer();
    document.addEventListener("keydown", (event) => this.onKey(event));
    window.addEventListener("themechange", () => this.showTheme());
    window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.showTheme());
    this.world.onMove = () => this.keepLink();
    app.listen((changed) => {
      if (changed.has("shownView")) document.body.dataset.shown = String(app.get().shownView);
      if (changed.size === 1 && changed.has("shownView")) return;
      this.keepLink();
      this.update(changed);
    });
    this.showTheme();
  }

  private addPanels(): void {
    const host = byId("images");
    this.panels.push(new ImagePanel(this.app, this.api, () => (this.app.run() ? this.app.get().run : -1)));
    if (this.app.scene.runs.length > 1)
      this.panels.push(new ImagePanel(this.app, this.api, () => this.app.get().compare));
    for (const panel of this.panels) {
      host.append(panel.root);
      panel.onPoint = (at) => this.showPointedAt(at);
      panel.onPick = (at) => {
        if (at.position) this.pickPlace(at.position);
      };
    }
  }

  private startAnnotating(annotator: Annotator): AnnotateKeys {
    document.body.classList.add("annotates");
    annotator.say = (text, isError) => this.say(text, isError);
    const [imagePanel] = this.panels;
    if (!imagePanel) throw new Error("there are no views to annotate");
    const masks = new MaskEditor(annotator, this.api, imagePanel);
    const panel = new AnnotatePanel(byId("inspector"), annotator, this.api, masks);
    const keys = new AnnotateKeys(annotator, panel, this.world);
    annotator.onChange = () => panel.show();
    const gizmo = this.world.gizmo();
    let held: Placement | null = null; // another one may be selected while its handles are dragged
    const showGizmo = () => {
      gizmo.setMode(panel.gizmo.mode, panel.gizmo.axes);
      if (gizmo.isDragging) return;
      const placement = annotator.selected();
      held = placement && isIn(placement, this.app.get().view) ? placement : null;
      gizmo.attach(held?.pose ?? null, this.app.object(placement?.object ?? -1)?.center);
    };
    panel.onGizmo = showGizmo;
    const showRegions = () => {
      const { view } = this.app.get();
      const open = annotator.annotation.regions.filter(
        (region) => region.view === view && region.verdict === "open" && !region.is_explained,
      );
      this.world.setGroup(
        "regions",
        open.map((region) => makeBox(region.pose, region.size_m, region.kind === "novel" ? "#46c67f" : "#ff6b76")),
      );
    };
    showRegions();
    gizmo.onDrag = (pose) => {
      this.sceneView.movePoints(this.app.get().track, pose);
      this.panels[0]?.showMoved({ object: annotator.selected()?.object ?? -1, pose });
    };
    gizmo.onDrop = (pose) => annotator.setPose(pose, panel.gizmo.mode === "rotate" ? "Turn" : "Move", held?.id);
    this.app.listen((changed) => {
      if (["view", "track", "edit"].some((key) => changed.has(key as "view"))) showGizmo();
      if (changed.has("view") || changed.has("edit")) showRegions();
    });
    imagePanel.onPlace = (at) => {
      if (annotator.placing < 0) return false;
      this.app.goTo(at.view); // the one that was clicked, even if another one is loading
      annotator.place(...at.pixel);
      return true;
    };
    return keys;
  }
  /** Places a model where a point of the 3D view is seen. */
  private async placeInWorld(position: Vec3): Promise<void> {
    const { view } = this.app.get();
    const pose = this.app.cameraPose(view);
    const { camera } = await this.api.view(view, 0);
    const pixel = pose ? project(camera, transformPoint(inverseRigid(pose), position)) : null;
    const [u, v] = (pixel ?? [-1, -1]).map(Math.round) as [number, number];
    if (u < 0 || v < 0 || u >= camera.width || v >= camera.height)
      this.say("The current view does not show this place.", true);
    else await this.annotator?.place(u, v);
  }

  async start(state: LinkState): Promise<void> {
    const { scene } = this.app;
    this.app.set(scene.is_live && state.view === 0 ? { ...state, view: Math.max(0, this.app.latestView()) } : state);
    const all = new Set(Object.keys(this.app.get()));
    const drawn = this.updateAll(all);
    if (scene.views.length > 1 && !scene.has_poses)
      this.say("The sequence has no camera poses: each view is drawn in the frame of its own camera.");
    // A view that cannot be read is no reason to show none: the address would lead to it again and again.
    await drawn.catch((error) => this.report(error));
    if (state.camera) this.world.setCamera(state.camera);
    else this.world.goHome();
    if (scene.is_live) this.follow().catch((error) => this.report(error));
    document.body.dataset.ready = "yes";
  }

  /** The first view that can be read decides where the 3D view looks from at first. */
  private async findHome(): Promise<void> {
    const { view, run, camera: asked } = this.app.get();
    const pose = this.app.cameraPose(view);
    if (!pose) return;
    const { camera } = await this.api.view(view, this.app.run() ? run : -1);
    const { depth } = await this.api.viewImages(view, camera);
    this.sceneView.home(guessUp([pose]), camera, depth, pose);
    this.hasHome = true;
    if (!asked) this.world.goHome();
  }

  private update(changed: ReadonlySet<string>): void {
    this.updateAll(changed).catch((error) => this.report(error));
  }

  private async updateAll(changed: ReadonlySet<string>): Promise<void> {
    const has = (...keys: string[]) => keys.some((key) => changed.has(key));
    const { view, compare } = this.app.get();
    const isNew = has("view", "run", "compare", "edit");
    if (isNew) this.app.set({ shownView: -1 });
    const isOtherModel = has("object") && this.app.scene.views.length === 0;
    if (has("view", "run", "compare") || isOtherModel) this.say("");
    document.body.classList.toggle("compares", compare >= 0 && this.panels.length > 1);
    if (has("view") && !(await this.startLoading(view))) return;
    if (has("view") && !this.hasHome) await this.findHome();
    const panels = this.panels.filter((_, index) => index === 0 || compare >= 0);
    await Promise.all([
      this.sceneView.update(changed),
      ...panels.map((panel) => (isNew ? panel.update() : panel.draw())),
    ]);
    const { hypothesis } = this.app.get();
    if (has("hypothesis", "view", "run")) await this.panels[0]?.showMoved(hypothesis);
    if (isNew && this.app.get().view === view) this.app.set({ shownView: view });
  }

  /** Waits until the view before is known: of views that are passed meanwhile, only the last one is asked for. False: the
   * view has been passed. */
  private async startLoading(view: number): Promise<boolean> {
    if (this.app.scene.views.length === 0) return true;
    await this.asked;
    if (this.app.get().view !== view) return false;
    this.asked = this.api.view(view, this.app.run() ? this.app.get().run : -1).catch(() => {});
    return true;
  }

  private report(error: unknown): void {
    this.app.set({ isPlaying: false });
    this.say(error instanceof Error ? error.message : String(error), true);
  }
  private say(text: string, isError = false): void {
    this.status.textContent = text;
    this.status.classList.toggle("error", isError);
  }

  private showPointedAt(at: PointedAt | null): void {
    if (!at) {
      this.readOut("");
      this.world.setMarker(this.app.get().point); // not where the pointer has been
      return;
    }
    const [u, v] = at.pixel;
    const depth = at.depth > 0 ? `depth ${metres(at.depth)}` : "no depth";
    this.readOut(`pixel ${u}, ${v} · ${depth}${at.position ? ` · world ${coordinates(at.position)} m` : ""}`);
    this.world.setMarker(at.position ?? this.app.get().point);
  }

  private pickPlace(position: Vec3): void {
    const { isMeasuring, measured } = this.app.get();
    if (isMeasuring)
      this.app.set({ measured: measured.length === 1 ? [...measured, position] : [position], point: position });
    else this.app.set({ point: position, track: -1, object: -1, event: null });
    this.say(this.withDistance(`world ${coordinates(position)} m`));
  }
  /** Tells where the pointer is; an error stays until something else is done. */
  private readOut(text: string): void {
    if (!this.status.classList.contains("error")) this.say(this.withDistance(text));
  }
  /** Adds the distance that was measured. */
  private withDistance(text: string): string {
    const [a, b] = this.app.get().measured;
    return a && b ? `${text}${text ? " · " : ""}distance ${metres(distance(a, b))}` : text;
  }

  private listenToPointer(): void {
    const { canvas } = this.world;
    let down: [number, number] = [0, 0];
    let isWaiting = false;
    let isOnHandle = false;
    const locate = (event: PointerEvent): [number, number] => {
      const box = canvas.getBoundingClientRect();
      return [event.clientX - box.left, event.clientY - box.top];
    };
    canvas.addEventListener("pointerdown", (event) => {
      down = locate(event);
      isOnHandle = this.annotator !== null && this.world.gizmo().isHovered;
    });
    canvas.addEventListener("pointerup", (event) => {
      const [x, y] = locate(event);
      if (event.button !== 0 || isOnHandle || Math.hypot(x - down[0], y - down[1]) > 4) return;
      this.pickInWorld(x, y);
    });
    canvas.addEventListener("pointermove", (event) => {
      if (event.buttons !== 0 || isWaiting) return;
      isWaiting = true;
      requestAnimationFrame(() => {
        isWaiting = false;
        const picked = this.world.pick(...locate(event));
        const name = picked && picked.object >= 0 ? ` · ${this.app.object(picked.object)?.name ?? ""}` : "";
        this.readOut(picked ? `world ${coordinates(picked.position)} m${name}` : "");
      });
    });
  }

  private pickInWorld(x: number, y: number): void {
    const picked = this.world.pick(x, y);
    if (picked && this.annotator && this.annotator.placing >= 0) {
      this.placeInWorld(picked.position).catch((error) => this.report(error));
      return;
    }
    if (!picked) this.app.selectNothing();
    else if (this.app.get().isMeasuring) this.pickPlace(picked.position);
    else if (picked.track >= 0) this.app.selectTrack(picked.track);
    else if (picked.object >= 0) this.app.selectObject(picked.object);
    else this.pickPlace(picked.position);
  }

  private onKey(event: KeyboardEvent): void {
    const target = event.target as HTMLElement;
    if (event.altKey || document.querySelector("dialog[open]")) return;
    if (target.matches("input:not([type=range]), select")) return;
    // The slider of the views steps through them as these keys do; others have values of their own.
    const isSlider = target.matches("#inspector input[type=range]");
    if (isSlider && /^(Arrow|Page|Home|End)/.test(event.key)) return;
    const edit = this.annotateKeys?.actionOf(event);
    if (edit) {
      this.act(event, edit);
      return;
    }
    if (event.ctrlKey || event.metaKey) return;
    if (event.key === " " && target.matches("button")) return;
    const action = this.actionOf(event.key);
    if (action) this.act(event, action);
  }
  private act(event: KeyboardEvent, action: () => void): void {
    event.preventDefault();
    if (!event.repeat || mayRepeat(event.key)) action();
  }

  private actionOf(key: string): (() => void) | undefined {
    const { app } = this;
    if (/^[1-9]$/.test(key)) return () => this.bar.toggleLayer(Number(key) - 1);
    const actions: Record<string, () => void> = {
      "?": () => this.bar.showHelp(),
      Escape: () => app.selectNothing(),
      d: toggleTheme,
      e: () => this.exportPicture(),
      l: () => this.copyLink(),
      r: () => this.world.goHome(),
      t: () => this.world.lookDown(),
    };
    if (this.timeline) {
      const { timeline } = this;
      Object.assign(actions, {
        ArrowLeft: () => app.goTo(app.get().view - 1),
        ArrowRight: () => app.goTo(app.get().view + 1),
        Home: () => app.goTo(0),
        End: () => app.goTo(app.scene.views.length - 1),
        " ": () => app.togglePlaying(),
        n: () => timeline.goToChange(1),
        p: () => timeline.goToChange(-1),
        m: () => app.set({ isMeasuring: !app.get().isMeasuring, measured: [] }),
        c: () => this.lookFromCamera(),
        f: () => this.lookAtSelection(),
      });
    }
    return actions[key.length === 1 ? key.toLowerCase() : key];
  }

  private lookFromCamera(): void {
    const pose = this.app.cameraPose(this.app.get().view);
    if (pose) this.world.lookFrom(pose, 1);
  }
  private lookAtSelection(): void {
    const place = this.sceneView.selectedPlace();
    if (place) this.world.lookAt(place.center, 3 * place.size);
  }

  private showTheme(): void {
    this.world.setBackground(isDark() ? "#10151b" : "#eef1f4");
  }

  private link(): string {
    return formatLink({ ...this.app.get(), camera: this.world.cameraState() }, this.token);
  }
  /** Keeps the state in the address, not more often than browsers allow. */
  private keepLink(): void {
    window.clearTimeout(this.linkTimer);
    this.linkTimer = window.setTimeout(() => this.writeLink(), 250);
  }
  private writeLink(): void {
    if (location.hash !== this.fragment) return; // another address was entered, and is about to be loaded
    history.replaceState(null, "", this.link());
    this.fragment = location.hash;
  }
  private copyLink(): void {
    this.writeLink();
    navigator.clipboard.writeText(location.href).then(
      () => this.say("The link is copied. It works while resight view runs."),
      () => this.say("The address of this page is the link."),
    );
  }

  private exportPicture(): void {
    this.world.draw();
    const images = this.panels.filter((_, index) => index === 0 || this.app.get().compare >= 0);
    const picture = makePicture(
      byId("world"),
      images.map((panel) => panel.picture()),
      isDark(),
    );
    picture.toBlob((blob) => {
      if (blob) download(`${this.app.scene.title}-view${this.app.get().view + 1}.png`, blob);
    });
  }

  /** Shows views as they are recognised. */
  private async follow(): Promise<void> {
    await follow(() => this.api.revisions(), {
      revision: () => this.app.scene.revision,
      isLive: () => this.app.scene.is_live,
      reload: () => this.reload(),
    });
  }

  private async reload(): Promise<void> {
    const isFollowing = this.app.get().view >= this.app.latestView();
    const scene = await this.api.scene();
    this.api.forgetDetails();
    this.app.setScene(scene);
    if (isFollowing) this.app.goTo(this.app.latestView());
  }
}

async function main(): Promise<void> {
  restoreTheme();
  // An address that differs in its fragment only, such as another token, loads nothing by itself.
  window.addEventListener("hashchange", () => location.reload());
  const token = parseLink(location.hash, { views: 0, runs: 0, objects: 0 }).token;
  const api = new Api(token);
  const scene = await api.scene();
  api.isAnnotated = scene.is_annotated === true;
  const annotation = api.isAnnotated ? await api.annotation() : null;
  if (annotation) {
    scene.runs = [
      toRun(
        annotation,
        scene.views.map((view) => view.pose),
      ),
    ];
    document.body.dataset.revision = String(annotation.revision);
  }
  const counts = { views: scene.views.length, runs: scene.runs.length, objects: scene.objects.length };
  const { state } = parseLink(location.hash, counts);
  const app = new App(scene);
  await new Viewer(app, api, token, annotation ? new Annotator(app, api, annotation) : null).start(state);
}

main().catch((error) => {
  const text = error instanceof Error ? error.message : String(error);
  document.body.append(element("div", { class: "failure", role: "alert" }, text));
});
