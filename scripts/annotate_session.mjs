// SPDX-License-Identifier: Apache-2.0
// One session of `resight annotate` by script, with the requests that the page sends. It knows the ground truth as an
// annotator sees the image: which object is where, and when it came and left. It does not know poses. Counts the clicks
// that the page needs. Usage: annotate_session.mjs RESIGHT MODELS SEQUENCE PROJECT [DETECTIONS]
import { spawn } from "node:child_process";
import { readFile } from "node:fs/promises";

const [resight, models, sequence, project, detections] = process.argv.slice(2);
const json = async (file) => JSON.parse(await readFile(`${sequence}/${file}`, "utf8"));

const multiply = (a, b) => Array.from({ length: 16 }, (_, i) => [0, 1, 2, 3].reduce((s, k) => s + a[(i % 4) + 4 * k] * b[k + 4 * (i >> 2)], 0));
const inverse = (m) => {
  const t = [12, 13, 14].map((i) => m[i]);
  const row = (r) => -(m[4 * r] * t[0] + m[4 * r + 1] * t[1] + m[4 * r + 2] * t[2]);
  return [m[0], m[4], m[8], 0, m[1], m[5], m[9], 0, m[2], m[6], m[10], 0, row(0), row(1), row(2), 1];
};
/** Column by column, metres. */
const toPose = (r, t) => [r[0], r[3], r[6], 0, r[1], r[4], r[7], 0, r[2], r[5], r[8], 0, ...t.map((v) => v / 1000), 1];
const at = (m, p) => [0, 1, 2].map((r) => m[r] * p[0] + m[r + 4] * p[1] + m[r + 8] * p[2] + m[r + 12]);
const distance = (a, b) => Math.hypot(...a.map((v, i) => v - b[i]));
const angle = (a, b) => {
  const r = multiply(inverse(a), b);
  const skew = Math.hypot(r[6] - r[9], r[8] - r[2], r[1] - r[4]);
  return (Math.atan2(skew / 2, (r[0] + r[5] + r[10] - 1) / 2) * 180) / Math.PI;
};
/** Beyond this, the outline or the texture is seen to be wrong, and the object is placed again. */
const kMaxTurn_deg = 20;
const median = (values) => [...values].sort((a, b) => a - b)[Math.floor(values.length / 2)];

/** The true placements: an object at one place, from view to view. */
async function readTruth(scene) {
  const [cameras, truth] = [await json("scene_camera.json"), await json("scene_gt.json")];
  const info = await json("scene_gt_info.json");
  const views = Object.keys(truth).map(Number).sort((a, b) => a - b);
  const placements = [];
  views.forEach((id, view) => {
    const camera = cameras[id];
    const world = inverse(toPose(camera.cam_R_w2c, camera.cam_t_w2c));
    truth[id].forEach((entry, index) => {
      const name = entry.name ?? scene.objects.find((object) => object.obj_id === entry.obj_id)?.name;
      if (!scene.objects.some((object) => object.name === name)) return; // it has no model
      const pose = multiply(world, toPose(entry.cam_R_m2c, entry.cam_t_m2c));
      const known = placements.find((p) => p.name === name && p.last === view - 1 && distance(p.pose.slice(12, 15), pose.slice(12, 15)) < 1e-4);
      const placement = known ?? { name, first: view, pose, seen: [] };
      placement.last = view;
      placement.seen.push({ view, share: info[id][index].visib_fract, k: camera.cam_K, cameraFromObject: toPose(entry.cam_R_m2c, entry.cam_t_m2c) });
      if (!known) placements.push(placement);
    });
  });
  return { placements, numViews: views.length };
}

const server = spawn(resight, ["annotate", "--no-open", "--models", models, "--sequence", sequence, "--out", project, ...(detections ? ["--detections", detections] : [])], { env: { ...process.env, DISPLAY: "" } });
process.on("exit", () => server.kill("SIGKILL"));
server.stderr.on("data", (data) => /^resight: /.test(data) && console.error(String(data)));
const address = await new Promise((resolve) => {
  let text = "";
  server.stdout.on("data", (data) => {
    text += data;
    const found = /(http:\S+)\/#token=(\S+)/.exec(text);
    if (found) resolve(found);
  });
});
const headers = { "X-Resight-Token": address[2] };
const ask = async (path, body) => {
  const response = await fetch(`${address[1]}/api/${path}`, body === undefined ? { headers } : { headers, method: "POST", body: JSON.stringify(body) });
  if (!response.ok) throw new Error(`${path}: ${response.status} ${await response.text()}`);
  return response.json();
};

const scene = await ask("scene");
const { placements: truth, numViews } = await readTruth(scene);
let state = await ask("annotation");
let clicks = 0;
const numOf = (name) => scene.objects.findIndex((object) => object.name === name);
const act = async (title, changes) => {
  state = await ask("annotation/actions", { revision: state.revision, action: { title, changes } });
};
const put = (placement) => ({ do: "put_object", id: -1, track: -1, ...placement });
const centerOf = (object, pose) => at(pose, scene.objects[object].center);
/** The annotated placement that shows the true one, if it is near enough to be snapped. */
const find = (t) =>
  state.objects.find((o) => o.object === numOf(t.name) && o.first_view <= t.last && o.last_view >= t.first && distance(centerOf(o.object, o.pose), centerOf(o.object, t.pose)) < 0.03 && angle(o.pose, t.pose) < kMaxTurn_deg);
const interval = (found, view) => {
  const gone = found.filter((r) => r.is_gone).map((r) => r.view);
  return [Math.max(-1, ...gone.filter((v) => v < view)) + 1, Math.min(numViews, ...gone.filter((v) => v > view)) - 1];
};

const begin = performance.now();
// What the recogniser has wrong: placements where nothing is. One click selects, one deletes.
for (const object of [...state.objects])
  if (!truth.some((t) => find(t)?.id === object.id)) {
    clicks += 2;
    await act("Delete", [{ do: "drop_object", id: object.id }]);
  }
// What is missing: go to a view that shows it well, choose the model, click on it.
const misplaced = [];
for (const t of truth) {
  if (find(t)) continue;
  const best = t.seen.reduce((a, b) => (b.share > a.share ? b : a));
  const p = at(best.cameraFromObject, scene.objects[numOf(t.name)].center);
  const [u, v] = [best.k[0] * (p[0] / p[2]) + best.k[2], best.k[4] * (p[1] / p[2]) + best.k[5]].map(Math.round);
  clicks += 3;
  const object = numOf(t.name);
  const { pose } = await ask("annotation/place", { object, view: best.view, u, v });
  const [first_view, last_view] = interval(await ask("annotation/assess", { object, pose }), best.view);
  const refined = await ask("annotation/refine", { object, pose, first_view, last_view, all_turns: true });
  await act(`Place ${t.name}`, [put({ object, first_view, last_view, pose: refined.pose })]);
  if (!find(t)) misplaced.push(t.name);
}
// One key fits all of them.
clicks += 1;
const snapped = [];
for (const o of state.objects) {
  const { pose } = await ask("annotation/refine", { object: o.object, pose: o.pose, first_view: o.first_view, last_view: o.last_view });
  snapped.push({ do: "put_object", ...o, pose });
}
await act("Snap all", snapped);
// Views in which it came and left, and which placements are one thing: one click selects, one corrects.
for (const t of truth) {
  const o = find(t);
  if (!o) continue;
  const earlier = truth.filter((s) => s.name === t.name && s.last < t.first).pop();
  const track = earlier ? (find(earlier)?.track ?? o.track) : o.track;
  if (o.first_view !== t.first || o.last_view !== t.last) clicks += 2;
  if (o.track !== track) clicks += 2;
  if (o.first_view === t.first && o.last_view === t.last && o.track === track) continue;
  await act("Correct", [put({ ...o, track, first_view: t.first, last_view: t.last })]);
}
const seconds = (performance.now() - begin) / 1000;

const errors = truth.map((t) => ({ name: t.name, first: t.first, o: find(t) })).filter(({ o }) => o).map(({ name, first, o }, i) => {
  const t = truth.find((each) => each.name === name && each.first === first);
  return { name, mm: 1000 * distance(centerOf(o.object, o.pose), centerOf(o.object, t.pose)), deg: angle(o.pose, t.pose), i };
});
const events = state.events.map((e) => `${e.kind} ${e.name} at view ${e.view + 1}`);
console.log(`from ${detections ? "detections" : "nothing"}: ${clicks} clicks, ${seconds.toFixed(1)} s of the program, ` +
  `${errors.length} of ${truth.length} placements, ${events.length} events, ${state.to_dos.length} to do`);
console.log(`  median error ${median(errors.map((e) => e.mm)).toFixed(2)} mm, ${median(errors.map((e) => e.deg)).toFixed(2)} deg; largest ${Math.max(...errors.map((e) => e.mm)).toFixed(2)} mm`);
for (const { name, mm, deg } of errors) console.log(`    ${name}: ${mm.toFixed(2)} mm, ${deg.toFixed(2)} deg`);
for (const event of events) console.log(`    ${event}`);
if (misplaced.length > 0) console.log(`  not found by a click: ${misplaced.join(", ")}`);
server.kill("SIGINT");
await new Promise((resolve) => server.on("exit", resolve));
