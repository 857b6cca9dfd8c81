// SPDX-License-Identifier: Apache-2.0
// The viewer in a real browser, against the real program. tests/viewer_test.sh makes the data and calls it:
//   RESIGHT          the program
//   RESULTS, OTHER   two folders of results on the same views, of which one is removed and one has moved
//   STRICT           results that miss everything; this one and RESULTS have a trace
//   MODELS           the model library
//   SEQUENCE         the views
//   CHANGES          results of 'resight changes' on them
//   LIVE             folder for new results
//   PICTURES         folder for pictures of the page
import assert from "node:assert/strict";
import { test } from "node:test";
import type { Page, Route } from "playwright-core";
import { browser, inspector, open, picture, serve, setting, waitForDrawing, waitForView } from "./page";

test("results: scrub, pick, select a change, keep a link, compare", async () => {
  const { address, stop } = await serve([setting("RESULTS"), setting("OTHER")]);
  const page = await open(address);

  // Load: the 3D view shows something, the image has its outlines, the timeline its changes.
  await waitForDrawing(page, 100);
  assert.equal(await page.locator(".labels3d span").count(), 2);
  assert.match((await page.locator("figure canvas").first().getAttribute("aria-label")) ?? "", /2 objects outlined/);
  assert.equal(await page.locator(".row[data-track] .mark").count(), 2);
  assert.match(await inspector(page), /Changes \(2\)/);
  await picture(page, "results");

  // Scrub, by slider and by keys.
  await page.locator("#timeline input[type=range]").fill("2");
  await waitForView(page, 2);
  await page.locator("#world canvas").focus();
  await page.keyboard.press("ArrowRight");
  await waitForView(page, 3);
  await page.keyboard.press("Home");
  await waitForView(page, 0);

  // Pick an object in the image, then the same one in 3D.
  await page.locator(".row .name", { hasText: "cereal_blue" }).click();
  assert.match(await inspector(page), /cereal_blue[\s\S]*score/);
  await page.keyboard.press("Escape");
  assert.match(await inspector(page), /Changes \(2\)/);
  await clickOn(page, ".labels3d span", "cereal_blue");
  await page.waitForSelector("#inspector h2:text('cereal_blue')");
  assert.match(await inspector(page), /to ground truth/);
  assert.match(await inspector(page), /Evidence by view/);

  // The keys lead to the changes, in order.
  await page.keyboard.press("n");
  await page.waitForSelector(".mark.selected.moved");
  await picture(page, "moved");
  await page.keyboard.press("n");
  await page.waitForSelector(".mark.selected.removed");
  await page.keyboard.press("p");
  await page.waitForSelector(".mark.selected.moved");
  await page.locator(".row[data-track] .mark.removed").click();
  await page.keyboard.press("f");
  await page.waitForSelector("#inspector h2:text('tea_box')");
  await picture(page, "removed");

  // A link restores all of it.
  await page.waitForFunction(() => location.hash.includes("track="));
  await page.waitForTimeout(400);
  const link = page.url();
  const shown = await inspector(page);
  await page.reload();
  await page.waitForSelector("body[data-ready=yes]");
  await page.waitForFunction(
    (text) => document.querySelector("#inspector")?.textContent === text,
    await text(page, "#inspector"),
  );
  assert.equal((await inspector(page)).split("\n")[0], shown.split("\n")[0]);
  await page.waitForTimeout(400);
  assert.equal(page.url(), link);

  // Compare with another run.
  await page.getByLabel("Compare with").selectOption("1");
  await page.waitForSelector("body.compares");
  assert.equal(await page.locator("figure.image:visible").count(), 2);
  await page.getByLabel("Colours of the objects").selectOption("evidence");
  await page.getByLabel("Colours of the points").selectOption("distance");
  await page.locator("button[data-layer=previous]").click();
  await page.locator("button[data-layer=truth]").click();
  await page.waitForSelector(".legend:visible");
  await page.keyboard.press("d");
  await picture(page, "compare");
  await page.getByLabel("Colours of the objects").selectOption("error");
  await page.getByText("15 mm farther").waitFor();
  await waitForDrawing(page, 100);
  await picture(page, "depth_error");
  assert.equal(await page.evaluate(() => document.documentElement.scrollWidth), 1280, "something is cut off");
  await page.setViewportSize({ width: 620, height: 500 });
  const rightEnds = (parts: string) =>
    page.locator(parts).evaluateAll((found) => found.map((each) => each.getBoundingClientRect().right));
  const [end = 0] = await rightEnds("#world");
  assert.ok(Math.max(...(await rightEnds(".layers button"))) <= end, "layers are out of reach in a small window");
  await page.setViewportSize({ width: 1280, height: 720 });
  await waitForDrawing(page, 100);

  // A picture of it.
  const download = page.waitForEvent("download");
  await page.getByRole("button", { name: "Export a picture" }).click();
  assert.match((await download).suggestedFilename(), /-view\d+\.png$/);
  await page.close();
  assert.equal(await stop(), 0, "Ctrl-C ends it well");
});

test("why something was found, or was not", async () => {
  const { address, stop } = await serve([setting("RESULTS"), setting("STRICT")]);
  const page = await open(address);

  // A click on an object tells which hypotheses were there; one of them is shown with its evidence.
  await clickOn(page, ".labels3d span", "cereal_blue");
  const accepted = page.locator(".why button", { hasText: "accepted" }).first();
  await accepted.click();
  await page.waitForSelector(".why button[aria-expanded=true]");
  assert.match(await inspector(page), /Why: hypotheses here[\s\S]*cereal_blue[\s\S]*from views[\s\S]*explained/);
  assert.match(await inspector(page), /ellipsoid/);
  await page.locator(".why dl").scrollIntoViewIfNeeded();
  await waitForDrawing(page, 100);
  await picture(page, "why");
  await page.keyboard.press("Escape");

  // Missed objects have the stage at which they were lost, and the number that decided it.
  await page.getByLabel("Run", { exact: true }).selectOption("1");
  const missed = page.getByRole("button", { name: "tea_box, lost at: rejected" });
  await missed.click();
  await page.waitForSelector(".why button[aria-expanded=true]");
  assert.match(
    await inspector(page),
    /lost at\s+rejected[\s\S]*best hypothesis[\s\S]*too few visible[\s\S]*visible share 0\.\d\d, needs 0\.95/,
  );
  await page.locator(".why dl").scrollIntoViewIfNeeded();
  await waitForDrawing(page, 100);
  await picture(page, "why_missed");

  // A place that is clicked has hypotheses, or there is none.
  await page.keyboard.press("Escape");
  await page
    .locator("figure canvas")
    .first()
    .click({ position: { x: 6, y: 6 } });
  await page.waitForSelector("#inspector h2:text('Place')");
  assert.match(await inspector(page), /Why: hypotheses here\s+There is none\./);

  // The objects of the run beside it are shown, too.
  await page.getByLabel("Compare with").selectOption("0");
  await page.waitForSelector("body.compares");
  await waitForDrawing(page, 100);
  await picture(page, "compare_objects");
  await page.close();
  assert.equal(await stop(), 0);
});

test("places have coordinates, and distances are measured", async () => {
  const { address, stop } = await serve([setting("RESULTS")]);
  const page = await open(address);
  const image = page.locator("figure canvas").first();
  await image.hover({ position: { x: 150, y: 150 } });
  await page.waitForFunction(() =>
    /pixel \d+, \d+ · depth .* · world /.test(document.querySelector("#status")?.textContent ?? ""),
  );

  // While the next view is loading, the image is that of this one, and so is what the pointer reads in it.
  const here = await readAt(page, 150, 150);
  const { route, release } = holdUp();
  await page.route("**/api/views/1/color", route);
  await page.keyboard.press("ArrowRight");
  await waitForView(page, -1);
  assert.equal(await readAt(page, 150, 150), here);
  release();
  await waitForView(page, 1);
  assert.notEqual(await readAt(page, 150, 150), here);
  await page.keyboard.press("ArrowLeft");
  await waitForView(page, 0);

  // The pointer moves its marker in the 3D view, whose points are not drawn anew.
  await countDrawings(page);
  const marker = page.locator(".labels3d .marker");
  await readAt(page, 150, 150);
  const first = await marker.boundingBox();
  await readAt(page, 200, 160);
  const second = await marker.boundingBox();
  assert.ok(first && second && Math.hypot(first.x - second.x, first.y - second.y) > 5);
  assert.equal(await page.evaluate(() => window.numDrawings), 0);

  // Of views that are passed, no images are loaded.
  const asked: string[] = [];
  page.on("request", (request) => asked.push(new URL(request.url()).pathname));
  const passed = holdUp();
  await page.route("**/api/views/2?*", passed.route);
  for (const view of [2, 3, 4]) await page.locator("#timeline input[type=range]").fill(String(view));
  await waitForView(page, -1);
  passed.release();
  await waitForView(page, 4);
  assert.ok(asked.includes("/api/views/4/depth"), asked.join());
  assert.ok(!asked.some((path) => /views\/[23]\/(color|depth)/.test(path)), asked.join());
  await page.keyboard.press("Home");
  await waitForView(page, 0);

  await page.keyboard.press("m");
  await image.click({ position: { x: 150, y: 150 } });
  await image.click({ position: { x: 200, y: 150 } });
  assert.match(await inspector(page), /distance\s+\d+ mm/);
  await page.keyboard.press("m");
  await page.keyboard.press("Escape");
  await page.locator("#world canvas").hover({ position: { x: 390, y: 300 } });
  await page.waitForFunction(() => /^world /.test(document.querySelector("#status")?.textContent ?? ""));
  await page.keyboard.press("?");
  await page.waitForSelector("dialog[open]");
  await picture(page, "keys");
  await page.keyboard.press("Escape");
  await page.keyboard.press("End");
  await page.waitForSelector('body[data-shown="4"]');
  // A busy browser draws so rarely that a look at each frame misses views.
  await page.evaluate(() => {
    const { body } = document;
    const note = () => body.setAttribute("data-played", `${body.dataset.played ?? ""} ${body.dataset.shown}`);
    new MutationObserver(note).observe(body, { attributes: true, attributeFilter: ["data-shown"] });
  });
  await page.keyboard.press("Space"); // plays from the start
  await page.waitForSelector('body[data-played$=" 4"]');
  const played = (await page.locator("body").getAttribute("data-played")) ?? "";
  assert.equal(played.replaceAll(" -1", ""), " 0 1 2 3 4");
  await page.close();

  // A view that cannot be read is reported; the others are shown.
  const broken = await openBroken(address, "**/api/views/0/color");
  await broken.waitForSelector("#status.error:text('it is damaged')");
  await broken.keyboard.press("ArrowRight");
  await waitForView(broken, 1);
  await waitForDrawing(broken, 100);
  assert.equal(await broken.locator("#status.error").count(), 0);
  await broken.close();
  assert.equal(await stop(), 0);
});

test("a sequence and a model library are shown as well", async () => {
  const models = await serve([setting("MODELS")]);
  const modelPage = await open(models.address);
  await waitForDrawing(modelPage, 50);
  await modelPage.getByRole("button", { name: "Select tea_box" }).click();
  await modelPage.waitForSelector("#inspector h2:text('tea_box')");
  assert.match(await inspector(modelPage), /diameter[\s\S]*keypoints/);
  await picture(modelPage, "models");

  // Layers are switched without a jump of the camera.
  await modelPage.waitForTimeout(400); // for the link
  await modelPage.keyboard.press("t");
  await modelPage.waitForTimeout(400);
  const camera = cameraOf(modelPage);
  await modelPage.locator("button[data-layer=labels]").click();
  await modelPage.waitForFunction(() => location.hash.includes("layers="));
  assert.equal(cameraOf(modelPage), camera);
  await modelPage.close();

  // A model that cannot be read is named; the others are shown.
  const broken = await openBroken(models.address, "**/api/surfaces/0");
  await broken.waitForSelector("#status.error");
  assert.match((await text(broken, "#status")) ?? "", /^cannot be shown: \w+ \(it is damaged\)$/);
  assert.equal(await broken.locator(".labels3d span").count(), 1);
  await waitForDrawing(broken, 50);
  await broken.close();
  assert.equal(await models.stop(), 0);

  const sequence = await serve([setting("SEQUENCE"), "--models", setting("MODELS"), "--changes", setting("CHANGES")]);
  const page = await open(sequence.address);
  await page.locator("button[data-layer=truth]").click();
  await page.waitForFunction(() => document.querySelectorAll(".labels3d span").length === 2);
  await waitForDrawing(page, 100);
  await picture(page, "sequence");
  await page.keyboard.press("End");
  await page.locator("button[data-layer=cloud]").click();
  await page.locator("button[data-layer=changes]").click();
  await page.keyboard.press("c");
  await waitForDrawing(page, 100);
  await picture(page, "changes");
  await page.close();
  assert.equal(await sequence.stop(), 0);

  // Without models, true objects have their names.
  const plain = await serve([setting("SEQUENCE")]);
  const plainPage = await open(plain.address);
  await plainPage.locator("button[data-layer=truth]").click();
  await plainPage.waitForFunction(() => document.querySelectorAll(".labels3d span").length === 2);
  assert.doesNotMatch((await plainPage.locator(".labels3d span").allTextContents()).join(), /\?/);
  await plainPage.close();
  assert.equal(await plain.stop(), 0);
});

test("views are shown as they are recognised", async () => {
  const inputs = ["--models", setting("MODELS"), "--sequence", setting("SEQUENCE"), "--out", setting("LIVE")];
  const { address, output, stop } = await serve(inputs, ["recognize", "--view", "--trace"]);
  const page = await open(address);
  await page.waitForFunction(() => document.querySelectorAll(".row[data-track]").length === 2);
  assert.ok((await numHypotheses(address, 0)) > 0, "the trace of a view comes with it");
  await page.waitForSelector(".mark.removed");
  await page.waitForFunction(() => document.querySelector("figcaption")?.textContent?.startsWith("5/5"));
  await page.close();
  for (let tries = 0; tries < 300 && !output().includes("report:"); ++tries)
    await new Promise((resolve) => setTimeout(resolve, 100));
  await new Promise((resolve) => setTimeout(resolve, 500)); // from the last line on, Ctrl-C ends the server
  assert.equal(await stop(), 0, "Ctrl-C ends it well after the last view");
});

test("without the token, the page says what to do", async () => {
  const { address, stop } = await serve([setting("MODELS")]);
  const page = await browser.newPage();
  await page.goto(address.replace(/#.*/, ""));
  assert.match((await page.locator(".failure").textContent()) ?? "", /open the address that resight printed/);
  await page.goto(address); // in the same tab, it differs in its fragment only
  await page.waitForSelector("body[data-ready=yes]");
  await page.close();
  assert.equal(await stop(), 0);
});

async function numHypotheses(address: string, view: number): Promise<number> {
  const { origin, hash } = new URL(address);
  const token = new URLSearchParams(hash.slice(1)).get("token") ?? "";
  const response = await fetch(`${origin}/api/views/${view}/trace?run=0`, { headers: { "X-Resight-Token": token } });
  return ((await response.json()) as { hypotheses: object[] }).hypotheses.length;
}

/** Opens the page where one request fails; open() takes that for a fault of the page. */
async function openBroken(address: string, requests: string): Promise<Page> {
  const page = await browser.newPage({ viewport: { width: 1280, height: 720 } });
  await page.route(requests, (route) => route.fulfill({ status: 500, body: "it is damaged" }));
  await page.goto(address);
  await page.waitForSelector("body[data-ready=yes]");
  return page;
}

/** Lets requests wait until they are released. */
function holdUp(): { route: (route: Route) => Promise<void>; release: () => void } {
  let release = () => {};
  const released = new Promise<void>((resolve) => {
    release = resolve;
  });
  const route = async (held: Route) => {
    await released;
    await held.continue();
  };
  return { route, release: () => release() };
}

declare global {
  interface Window {
    numDrawings: number;
  }
}
/** Counts from now on how often points are drawn, once what is being drawn has come to rest. */
async function countDrawings(page: Page): Promise<void> {
  await page.evaluate(() => {
    window.numDrawings = 0;
    const prototype = WebGL2RenderingContext.prototype;
    const draw = prototype.drawArrays;
    prototype.drawArrays = function (mode, first, count) {
      if (mode === this.POINTS) ++window.numDrawings;
      draw.call(this, mode, first, count);
    };
  });
  for (let last = -1; last !== (await page.evaluate(() => window.numDrawings)); ) {
    last = await page.evaluate(() => window.numDrawings);
    await page.waitForTimeout(500);
  }
  await page.evaluate(() => {
    window.numDrawings = 0;
  });
}

/** What the page says of a place in the image. */
async function readAt(page: Page, x: number, y: number): Promise<string> {
  await page.mouse.move(640, 719);
  await page.waitForFunction(() => document.querySelector("#status")?.textContent === "");
  await page.locator("figure canvas").first().hover({ position: { x, y } });
  await page.waitForFunction(() => document.querySelector("#status")?.textContent?.includes("world"));
  return (await text(page, "#status")) ?? "";
}

const cameraOf = (page: Page) => new URLSearchParams(new URL(page.url()).hash.slice(1)).get("camera");

const text = (page: Page, selector: string) => page.locator(selector).evaluate((part) => part.textContent);

/** Clicks on what lies under a label of the 3D view; labels themselves let clicks pass. */
async function clickOn(page: Page, selector: string, name: string): Promise<void> {
  const label = page.locator(selector, { hasText: name });
  await label.waitFor();
  const box = await label.boundingBox();
  assert.ok(box, `no label ${name}`);
  await page.mouse.click(box.x + box.width / 2, box.y + box.height + 2);
}
