// SPDX-License-Identifier: Apache-2.0
// What the browser tests share: the program as a server, and its page in Chromium.
import assert from "node:assert/strict";
import { type ChildProcess, spawn } from "node:child_process";
import { mkdir } from "node:fs/promises";
import { after, before } from "node:test";
import { type Browser, chromium, type Page } from "playwright-core";

export function setting(name: string): string {
  const value = process.env[name];
  if (!value) throw new Error(`${name} is not set`);
  return value;
}

const kBrowser = process.env.CHROMIUM ?? "/usr/bin/chromium";
// Without a graphics card, WebGL is drawn by SwiftShader, which Chromium does not use unless it is told to.
const kBrowserArguments = ["--enable-unsafe-swiftshader", "--use-angle=swiftshader", "--no-sandbox"];

// Without a desktop, the program opens no browser of its own.
const kNoDesktop = { ...process.env, DISPLAY: undefined, WAYLAND_DISPLAY: undefined };

export let browser: Browser;
const servers: ChildProcess[] = [];

before(async () => {
  await mkdir(setting("PICTURES"), { recursive: true });
  browser = await chromium.launch({ executablePath: kBrowser, args: kBrowserArguments });
});
after(async () => {
  for (const server of servers) server.kill("SIGKILL"); // those of tests that have failed
  await browser.close();
});

export interface Served {
  address: string;
  output: () => string;
  stop: () => Promise<number | null>;
}

/** Starts the program; resolves when it has printed its address. */
export async function serve(inputs: string[], command = ["view", "--no-open"]): Promise<Served> {
  const server: ChildProcess = spawn(setting("RESIGHT"), [...command, ...inputs], { env: kNoDesktop });
  servers.push(server);
  const ended = new Promise<number | null>((resolve) => server.on("exit", resolve));
  let output = "";
  const address = await new Promise<string>((resolve, reject) => {
    server.stderr?.on("data", (data) => {
      if (String(data).startsWith("resight: ")) reject(new Error(String(data)));
    });
    server.on("exit", () => reject(new Error("resight view has ended")));
    server.stdout?.on("data", (data) => {
      output += data;
      const line = /^(http:\/\/127\.0\.0\.1:\d+\/#token=[0-9a-f]{32})\n/.exec(output);
      if (line?.[1]) resolve(line[1]);
    });
  });
  const stop = () => {
    server.kill("SIGINT");
    return ended;
  };
  return { address, output: () => output, stop };
}

/** Opens the page and fails the test for any error in it, and for any request to another server. */
export async function open(address: string): Promise<Page> {
  const page = await browser.newPage({ viewport: { width: 1280, height: 720 }, colorScheme: "dark" });
  page.on("pageerror", (error) => assert.fail(`error in the page: ${error.message}`));
  page.on("console", (message) => {
    if (message.type() === "error") assert.fail(`error in the page: ${message.text()}`);
  });
  page.on("request", (request) => {
    const { protocol, host } = new URL(request.url());
    assert.ok(protocol === "blob:" || host === new URL(address).host, `a request to ${request.url()}`);
  });
  await page.goto(address);
  await page.waitForSelector("body[data-ready=yes]");
  return page;
}

export async function waitForView(page: Page, view: number): Promise<void> {
  await page.waitForSelector(`body[data-shown="${view}"]`);
}

/** Waits until the 3D view has at least so many colours. An empty one has one. */
export async function waitForDrawing(page: Page, minColors: number): Promise<void> {
  let count = 0;
  for (let tries = 0; tries < 50 && count < minColors; ++tries) {
    if (tries > 0) await page.waitForTimeout(100);
    count = await countColors(page);
  }
  assert.ok(count >= minColors, `the 3D view is blank: ${count} colours`);
}

function countColors(page: Page): Promise<number> {
  return page.evaluate(() => {
    const drawing = document.querySelector<HTMLCanvasElement>("#world canvas");
    const copy = document.createElement("canvas");
    copy.width = 160;
    copy.height = 120;
    const context = copy.getContext("2d");
    if (!drawing || !context) return 0;
    context.drawImage(drawing, 0, 0, copy.width, copy.height);
    const { data } = context.getImageData(0, 0, copy.width, copy.height);
    const colors = new Set<number>();
    for (let i = 0; i < data.length; i += 4)
      colors.add(((data[i] ?? 0) << 16) | ((data[i + 1] ?? 0) << 8) | (data[i + 2] ?? 0));
    return colors.size;
  });
}

export const picture = (page: Page, name: string) => page.screenshot({ path: `${setting("PICTURES")}/${name}.png` });
// biome-ignore lint/performance/useDomNodeTextContent: lines of the page are told apart
export const inspector = (page: Page) => page.locator("#inspector").innerText({ timeout: 5000 });
