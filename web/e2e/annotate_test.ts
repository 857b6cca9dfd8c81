// SPDX-License-Identifier: Apache-2.0
// `resight annotate` in a real browser. tests/annotate_test.sh makes the data and calls it:
//   RESIGHT   the program
//   MODELS    the model library
//   SEQUENCE  5 views in which the box of cereals moves at view 2 and the box of tea is removed at view 3
//   PROJECT   folder for the project
//   PICTURES  folder for pictures of the page
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { test } from "node:test";
import type { Page } from "playwright-core";
import { browser, inspector, open, picture, serve, setting, waitForDrawing, waitForView } from "./page";

interface Shown {
  revision: number;
  objects: { id: number; track: number; object: number; first_view: number; last_view: number; pose: number[] }[];
}

const inputs = (project = setting("PROJECT")) => [
  "--models",
  setting("MODELS"),
  "--sequence",
  setting("SEQUENCE"),
  "--out",
  project,
];
const command = ["annotate", "--no-open"];

async function annotation(address: string): Promise<Shown> {
  const { origin, hash } = new URL(address);
  const token = new URLSearchParams(hash.slice(1)).get("token") ?? "";
  const response = await fetch(`${origin}/api/annotation`, { headers: { "X-Resight-Token": token } });
  assert.equal(response.status, 200);
  return (await response.json()) as Shown;
}

const waitForRevision = (page: Page, revision: number) => page.waitForSelector(`body[data-revision="${revision}"]`);
const click = (page: Page, name: string) => page.locator("#inspector").getByText(name, { exact: true }).click();

/** Clicks on a pixel of the image, which has 320 x 240. */
async function clickPixel(page: Page, u: number, v: number): Promise<void> {
  const canvas = page.locator("figure canvas").first();
  const box = await canvas.boundingBox();
  assert.ok(box);
  await canvas.click({ position: { x: ((u + 0.5) / 320) * box.width, y: ((v + 0.5) / 240) * box.height } });
}

/** Presses a key with Shift twice, without a pause: on a busy machine, two real presses come as two edits. */
const pressTwiceAtOnce = (page: Page, key: string) =>
  page.locator("#world canvas").evaluate((canvas, pressed) => {
    for (let i = 0; i < 2; ++i)
      canvas.dispatchEvent(new KeyboardEvent("keydown", { key: pressed, shiftKey: true, bubbles: true }));
  }, key);

/** The place of a label in the page, once it is drawn and rests. */
async function restingBox(
  page: Page,
  selector: string,
): Promise<{ x: number; y: number; width: number; height: number }> {
  const label = page.locator(selector);
  await label.waitFor();
  for (let last = ""; ; await page.waitForTimeout(100)) {
    const box = await label.boundingBox();
    if (box && JSON.stringify(box) === last) return box;
    last = JSON.stringify(box);
  }
}

/** The pixel that shows an object of the ground truth, 4 cm above its lower side. */
async function pixelOf(name: string, view = "0"): Promise<[number, number]> {
  const read = async (file: string) => JSON.parse(await readFile(`${setting("SEQUENCE")}/${file}`, "utf8"));
  const k: number[] = (await read("scene_camera.json"))[view].cam_K;
  const objects: { name: string; cam_R_m2c: number[]; cam_t_m2c: number[] }[] = (await read("scene_gt.json"))[view];
  const object = objects.find((each) => each.name === name);
  assert.ok(object, name);
  const [x = 0, y = 0, z = 1] = object.cam_t_m2c.map((t, i) => t + 40 * (object.cam_R_m2c[3 * i + 2] ?? 0));
  const at = (i: number) => k[i] ?? 0;
  return [Math.round((at(0) * x) / z + at(2)), Math.round((at(4) * y) / z + at(5))];
}

test("annotate: place, snap, move, undo, redo, reload, two windows, export", async () => {
  const { address, stop } = await serve(inputs(), command);
  const page = await open(address);
  await waitForDrawing(page, 100);

  // Place by click: the pose, and the views in which the object is there, follow.
  for (const [index, name] of ["cereal_blue", "tea_box"].entries()) {
    await page.locator(`button[data-model=${name}]`).click();
    await clickPixel(page, ...(await pixelOf(name)));
    await waitForRevision(page, index + 1);
    assert.match(await inspector(page), new RegExp(name));
  }
  let shown = await annotation(address);
  assert.deepEqual(
    shown.objects.map((each) => [each.first_view, each.last_view]),
    [
      [0, 1],
      [0, 2],
    ],
  );
  await page.waitForSelector(".residuals");
  await waitForDrawing(page, 100);
  await picture(page, "annotate");

  // Move by keys, by numbers, by the handles; undo and redo.
  await page.locator("#world canvas").focus();
  const before = shown.objects[1]?.pose ?? [];
  await pressTwiceAtOnce(page, "ArrowLeft");
  await waitForRevision(page, 3);
  shown = await annotation(address);
  const moved = Math.hypot(...[12, 13, 14].map((i) => (shown.objects[1]?.pose[i] ?? 0) - (before[i] ?? 0)));
  assert.ok(Math.abs(moved - 0.002) < 1e-6, `moved by ${moved} m`);
  await page.keyboard.press("Control+z");
  await waitForRevision(page, 4);
  assert.deepEqual((await annotation(address)).objects[1]?.pose, before);
  await page.keyboard.press("Control+y");
  await waitForRevision(page, 5);
  const x = page.locator(".numbers input").first();
  await x.fill(String(Number(await x.inputValue()) + 5));
  await x.press("Enter");
  await waitForRevision(page, 6);
  // Else the next keys would be shortcuts: Delete would delete the object.
  assert.equal(await page.locator(".numbers input:focus").count(), 1, "the field that is typed into stays");
  await page.locator("#world canvas").focus();
  await page.keyboard.press("s");
  await waitForRevision(page, 7);
  shown = await annotation(address);
  const rest = Math.hypot(...[12, 13, 14].map((i) => (shown.objects[1]?.pose[i] ?? 0) - (before[i] ?? 0)));
  assert.ok(rest < 0.001, `snap leaves ${rest} m`);

  // The other place of the cereals, in view 2, as the same thing.
  await page.keyboard.press("ArrowRight");
  await page.keyboard.press("ArrowRight");
  await waitForView(page, 2);
  await page.locator("button[data-model=cereal_blue]").click();
  await clickPixel(page, ...(await pixelOf("cereal_blue", "2")));
  await waitForRevision(page, 8);
  const track = page.locator("#inspector select");
  await track.selectOption("0");
  await waitForRevision(page, 9);
  await page.waitForSelector(".row[data-track='0'] .mark.moved");
  await page.waitForSelector(".row[data-track='1'] .mark.removed");
  await waitForDrawing(page, 100);
  await picture(page, "annotate_moved");
  await page.locator("#world canvas").focus();
  await page.keyboard.press("k");
  await waitForRevision(page, 10);
  assert.match(await inspector(page), /view 3 of 5, 4 unchecked/);

  // A click on the handle at the centre of the object measures nothing and changes nothing.
  const label = await restingBox(page, ".labels3d span.selected");
  const [left, top] = [label.x + label.width / 2, label.y + label.height];
  const pressHandle = async () => {
    await page.mouse.move(left - 2, top);
    await page.mouse.move(left, top, { steps: 3 });
    await page.mouse.down();
  };
  const status = async () => (await page.locator("#status").textContent()) ?? "";
  await page.keyboard.press("m");
  await pressHandle();
  await page.mouse.up();
  await clickPixel(page, ...(await pixelOf("cereal_blue", "2")));
  assert.doesNotMatch(await status(), /distance/);
  await clickPixel(page, ...(await pixelOf("tea_box", "2")));
  assert.match(await status(), /distance [\d.]+ m/);
  await page.keyboard.press("m");
  assert.equal((await annotation(address)).revision, 10);

  // Drag the object by this handle, and undo that.
  await pressHandle();
  await page.mouse.move(left + 40, top + 10, { steps: 6 });
  await page.mouse.up();
  await waitForRevision(page, 11);
  assert.notDeepEqual((await annotation(address)).objects[2]?.pose, shown.objects[2]?.pose);
  await click(page, "Undo");
  await waitForRevision(page, 12);

  // Reload: everything is there.
  await page.reload();
  await page.waitForSelector("body[data-ready=yes]");
  await waitForRevision(page, 12);

  // Two windows: the second one is told, and loads the changes of the first.
  const other = await browser.newPage();
  await other.goto(address);
  await other.waitForSelector("body[data-ready=yes]");
  await page.locator("#world canvas").focus();
  await page.keyboard.press("k");
  await waitForRevision(page, 13);
  await other.locator("#world canvas").focus();
  await other.keyboard.press("k");
  await other.waitForFunction(() => /Another window/.test(document.querySelector("#status")?.textContent ?? ""));
  await waitForRevision(other, 13);
  assert.equal((await annotation(address)).revision, 13);
  await other.close();

  await click(page, "Export");
  await page.waitForFunction(() => /Exported/.test(document.querySelector("#status")?.textContent ?? ""));
  await page.close();
  assert.equal(await stop(), 0, "Ctrl-C ends it well");

  // A new start continues, and a killed one loses nothing.
  const again = await serve(inputs(), command);
  assert.equal((await annotation(again.address)).revision, 13);
  assert.equal(await again.stop(), 0);
});

interface Regions extends Shown {
  regions: { view: number; kind: string; verdict: string; is_corrected: boolean; pose: number[] }[];
  unknown_events: { kind: string; before: number[] | null; after: number[] | null }[];
}

test("annotate: masks of regions, and a move of a thing without model", async () => {
  const project = `${setting("PROJECT")}_regions`;
  const begin = () => serve(inputs(project), command);
  const { address, stop } = await begin();
  const page = await open(address);
  const regions = async () => (await annotation(address)) as Regions;
  const ask = async (path: string) => {
    const { origin, hash } = new URL(address);
    const token = new URLSearchParams(hash.slice(1)).get("token") ?? "";
    return (await fetch(`${origin}/api/annotation/${path}`, { headers: { "X-Resight-Token": token } })).json();
  };
  const sum = (runs: number[]) => runs.filter((_, i) => i % 2 === 1).reduce((total, each) => total + each, 0);
  const found = (await regions()).regions;
  const came = found.findIndex((each) => each.kind === "novel" && each.view === 2);
  const left = found.findIndex((each) => each.kind === "removed" && each.view === 2);
  assert.ok(came >= 0 && left >= 0, JSON.stringify(found));

  // Add with the brush, remove with the lasso; each stroke can be undone.
  const row = page.locator(".to-do", { hasText: "view 3: something came" }).first();
  await row.getByText("Mask", { exact: true }).click();
  await waitForView(page, 2);
  await page.waitForSelector("#inspector h2:text('Mask of what came before view 3')");
  const image = page.locator("figure canvas").first();
  const box = await image.boundingBox();
  assert.ok(box);
  const drag = async (points: [number, number][]) => {
    const at = ([u, v]: [number, number]): [number, number] => [
      box.x + ((u + 0.5) / 320) * box.width,
      box.y + ((v + 0.5) / 240) * box.height,
    ];
    const [first, ...rest] = points.map(at);
    assert.ok(first);
    await page.mouse.move(...first);
    await page.mouse.down();
    const before = await page.locator("#status").textContent();
    for (const point of rest) await page.mouse.move(...point, { steps: 4 });
    assert.equal(await page.locator("#status").textContent(), before, "a stroke reads nothing out");
    await page.mouse.up();
  };
  const proposed = sum((await ask(`regions/${came}`)).proposed);
  await drag([
    [20, 20],
    [60, 20],
  ]);
  await waitForRevision(page, 1);
  const painted = sum((await ask(`regions/${came}`)).corrected);
  assert.ok(painted > proposed + 400 && painted < proposed + 1000, `${proposed} pixels, then ${painted}`);
  await page.waitForTimeout(200);
  await picture(page, "annotate_mask");
  const radius = page.getByLabel("Radius of the brush in pixels");
  await radius.press("ArrowRight");
  assert.equal(await radius.inputValue(), "7", "arrow keys change the radius, not the view");
  await click(page, "Lasso −");
  await drag([
    [0, 0],
    [319, 0],
    [319, 40],
    [0, 40],
    [0, 0],
  ]);
  await waitForRevision(page, 2);
  assert.ok(sum((await ask(`regions/${came}`)).corrected) <= proposed);
  await page.keyboard.press("Control+z");
  await waitForRevision(page, 3);
  assert.equal(sum((await ask(`regions/${came}`)).corrected), painted);
  await click(page, "As proposed");
  await waitForRevision(page, 4);
  assert.equal((await ask(`regions/${came}`)).corrected, null);
  await page.keyboard.press("Control+z");
  await waitForRevision(page, 5);
  await page.keyboard.press("Escape");

  // A thing without model moved: one region is where it was, the other one where it is.
  await row.getByText("Moved", { exact: true }).click();
  assert.match((await page.locator("#status").textContent()) ?? "", /Press Moved at the place that it left/);
  await page
    .locator(".to-do", { hasText: "view 3: something left" })
    .first()
    .getByText("Moved", { exact: true })
    .click();
  await waitForRevision(page, 6);
  const moved = await regions();
  assert.equal(moved.unknown_events[0]?.kind, "moved");
  assert.deepEqual(moved.unknown_events[0]?.after, found[came]?.pose.slice(12, 15));
  assert.deepEqual(moved.unknown_events[0]?.before, found[left]?.pose.slice(12, 15));
  assert.equal(moved.regions[came]?.verdict, "accepted");
  assert.equal(moved.regions[came]?.is_corrected, true, "the verdict keeps the mask");
  assert.match(await inspector(page), /unknown moved[\s\S]*Regions of this view[\s\S]*mask corrected/);
  await picture(page, "annotate_unknown_moved");

  // Two presses before the server has answered make one event.
  const unknown = page.locator(".to-do", { hasText: "view 4: something left" }).getByText("Unknown", { exact: true });
  await unknown.first().evaluate((pressed: HTMLButtonElement) => {
    pressed.click();
    pressed.click();
  });
  await waitForRevision(page, 7);
  await page.waitForSelector("body:not([data-busy])");
  assert.equal((await regions()).unknown_events.length, 2);
  assert.equal((await regions()).revision, 7);
  await page.close();
  assert.equal(await stop(), 0);
  const exported = JSON.parse(await readFile(`${project}/export/regions/regions.json`, "utf8")).regions;
  assert.equal(exported.length, 3);

  // The next start finds the regions in the project.
  const again = await begin();
  assert.equal(((await annotation(again.address)) as Regions).regions[came]?.is_corrected, true);
  assert.equal(await again.stop(), 0);
});

test("annotate: wrong requests are refused", async () => {
  const { address, stop } = await serve(inputs(`${setting("PROJECT")}_refused`), command);
  const { origin, hash } = new URL(address);
  const token = new URLSearchParams(hash.slice(1)).get("token") ?? "";
  const post = async (path: string, body: string, headers: Record<string, string> = { "X-Resight-Token": token }) =>
    (await fetch(`${origin}/api/annotation${path}`, { method: "POST", body, headers })).status;
  const { revision } = await annotation(address);
  const edit = (change: object) => JSON.stringify({ revision, action: { title: "t", changes: [change] } });
  const pose = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 1, 1];
  assert.equal(await post("/actions", edit({ do: "drop_object", id: 0 }), {}), 403);
  assert.equal(await post("/actions", "{"), 400);
  assert.equal(await post("/actions", edit({ do: "drop_object", id: 99 })), 400);
  assert.equal(await post("/actions", edit({ do: "put_object", object: 77, first_view: 0, last_view: 1, pose })), 400);
  assert.equal(await post("/actions", edit({ do: "put_object", object: 0, first_view: 0, last_view: 9, pose })), 400);
  assert.equal(await post("/actions", edit({ do: "check_view", view: 0, is_checked: true }).replace(/\d+/, "7")), 409);
  assert.equal(await post("/refine", JSON.stringify({ object: 0, pose: [], first_view: 0, last_view: 1 })), 400);
  assert.equal(await post("/place", JSON.stringify({ object: 0, view: 0, u: 999, v: 0 })), 400);
  assert.equal(await post("/actions", `"${"x".repeat(70_000)}"`), 400, "a large body is read");
  assert.equal(await post("/actions", `"${"x".repeat(1_100_000)}"`), 413);
  assert.equal((await annotation(address)).revision, revision);
  assert.equal(await stop(), 0);
});
