// SPDX-License-Identifier: Apache-2.0
// Bundles the page into dist/, which is committed and becomes part of the program. With --tests, bundles the unit tests
// and the browser test into build/ instead, for Node.
import { copyFile, mkdir, readdir, readFile, rm, stat, writeFile } from "node:fs/promises";
import { build } from "esbuild";

const kMaxBundleBytes = 1 << 20;

async function bundlePage() {
  await mkdir("dist", { recursive: true });
  await build({
    entryPoints: ["src/main.ts"],
    outfile: "dist/viewer.js",
    bundle: true,
    minify: true,
    format: "esm",
    target: "es2022",
    charset: "utf8",
    legalComments: "none",
  });
  await build({ entryPoints: ["src/viewer.css"], outfile: "dist/viewer.css", minify: true });
  await copyFile("src/index.html", "dist/index.html");
  await copyFile("src/icon.svg", "dist/icon.svg");
  const { version } = JSON.parse(await readFile("node_modules/three/package.json", "utf8"));
  const license = await readFile("node_modules/three/LICENSE", "utf8");
  await writeFile("dist/licenses.txt", `viewer.js contains three.js ${version}, https://threejs.org\n\n${license}`);
  let size = 0;
  for (const file of await readdir("dist")) size += (await stat(`dist/${file}`)).size;
  if (size > kMaxBundleBytes) throw new Error(`dist/ has ${size} bytes, at most ${kMaxBundleBytes} are allowed`);
  console.log(`dist: ${size} bytes`);
}

async function bundleTests() {
  await rm("build", { recursive: true, force: true });
  const entryPoints = [];
  for (const folder of ["tests", "e2e"])
    for (const file of await readdir(folder)) if (file.endsWith("_test.ts")) entryPoints.push(`${folder}/${file}`);
  await build({
    entryPoints,
    outdir: "build",
    outbase: ".",
    bundle: true,
    platform: "node",
    format: "esm",
    target: "node18",
    external: ["playwright-core"],
    outExtension: { ".js": ".mjs" },
  });
}

await (process.argv.includes("--tests") ? bundleTests() : bundlePage());
