// SPDX-License-Identifier: Apache-2.0
// Writes the MCAP files of this folder with @mcap/core, and the ROS 2 messages for make_bags.py as JSON:
//   npm install @mcap/core @foxglove/rosmsg @foxglove/rosmsg2-serialization @foxglove/rosmsg-msgs-common zstd-codec lz4js
//   node make_mcap.mjs ros2_messages.json
import fs from "node:fs";
import { McapWriter } from "@mcap/core";
import { MessageWriter } from "@foxglove/rosmsg2-serialization";
import { ros2humble } from "@foxglove/rosmsg-msgs-common";
import zstdCodec from "zstd-codec";
import lz4 from "lz4js";

const WIDTH = 16, HEIGHT = 12, VIEWS = 4;
const K = [20, 0, 7.5, 0, 21, 5.5, 0, 0, 1];

function definitionsOf(name, seen = new Map()) {
  if (seen.has(name)) return [...seen.values()];
  const definition = ros2humble[name];
  seen.set(name, { ...definition, name: name.replace("/", "/msg/") });
  for (const field of definition.definitions)
    if (field.isComplex === true) definitionsOf(field.type, seen);
  return [...seen.values()];
}
function writerOf(name) {
  const definitions = definitionsOf(name).map((d, i) => ({
    name: i === 0 ? undefined : d.name,
    definitions: d.definitions.map((f) => (f.isComplex === true ? { ...f, type: f.type.replace("/", "/msg/") } : f)),
  }));
  return new MessageWriter(definitions);
}
const stamp = (seconds) => ({ sec: Math.floor(seconds + 1e-9), nanosec: Math.round((seconds % 1) * 1e9) % 1000000000 });
const header = (seconds, frame_id) => ({ stamp: stamp(seconds), frame_id });
const frame = "camera_color_optical_frame";

function color(i) {
  const data = new Uint8Array(3 * WIDTH * HEIGHT);
  for (let v = 0; v < HEIGHT; ++v)
    for (let u = 0; u < WIDTH; ++u) data.set([10 * u + i, 15 * v, 100], 3 * (v * WIDTH + u));
  return { header: header(100 + 0.1 * i, frame), height: HEIGHT, width: WIDTH, encoding: "rgb8", is_bigendian: 0,
           step: 3 * WIDTH, data };
}
function depth(i) {
  const values = new Float32Array(WIDTH * HEIGHT);
  for (let v = 0; v < HEIGHT; ++v)
    for (let u = 0; u < WIDTH; ++u) values[v * WIDTH + u] = u + v === 0 ? NaN : (1000 + 10 * u + i) / 1000;
  return { header: header(100.005 + 0.1 * i, frame), height: HEIGHT, width: WIDTH, encoding: "32FC1", is_bigendian: 0,
           step: 4 * WIDTH, data: new Uint8Array(values.buffer) };
}
const info = { header: header(99, frame), height: HEIGHT, width: WIDTH, distortion_model: "plumb_bob", d: [0, 0, 0, 0, 0],
               k: K, r: [1, 0, 0, 0, 1, 0, 0, 0, 1], p: [20, 0, 7.5, 0, 0, 21, 5.5, 0, 0, 0, 1, 0], binning_x: 0,
               binning_y: 0, roi: { x_offset: 0, y_offset: 0, height: 0, width: 0, do_rectify: false } };
const transform = (parent, child, seconds, [x, y, z], [qx, qy, qz, qw]) => ({
  transforms: [{ header: header(seconds, parent), child_frame_id: child,
                 transform: { translation: { x, y, z }, rotation: { x: qx, y: qy, z: qz, w: qw } } }] });

const messages = [];
const add = (topic, type, seconds, message) =>
  messages.push({ topic, type: type.replace("/", "/msg/"), time: BigInt(Math.round(seconds * 1e9)),
                  data: writerOf(type).writeMessage(message) });
add("/tf_static", "tf2_msgs/TFMessage", 99,
    transform("camera_link", frame, 99, [0, 0.02, 0], [-0.5, 0.5, -0.5, 0.5]));
add("/camera/color/camera_info", "sensor_msgs/CameraInfo", 99, info);
for (let i = 0; i <= VIEWS; ++i) {
  add("/tf", "tf2_msgs/TFMessage", 100 + 0.1 * i,
      transform("world", "camera_link", 100 + 0.1 * i, [0.1 * i, 0, 0], [0, 0, 0, 1]));
  if (i === VIEWS) break;
  add("/camera/color/image_raw", "sensor_msgs/Image", 100.01 + 0.1 * i, color(i));
  add("/camera/aligned_depth_to_color/image_raw", "sensor_msgs/Image", 100.012 + 0.1 * i, depth(i));
}

class Buffer2 {
  bytes = [];
  length = 0n;
  position() { return this.length; }
  async write(chunk) { this.bytes.push(Buffer.from(chunk)); this.length += BigInt(chunk.byteLength); }
}
async function write(name, options) {
  const writable = new Buffer2();
  const writer = new McapWriter({ writable, chunkSize: 2000, ...options });
  await writer.start({ profile: "ros2", library: "" });
  const channels = new Map();
  let sequence = 0;
  for (const m of messages) {
    if (!channels.has(m.topic)) {
      const schemaId = await writer.registerSchema({ name: m.type, encoding: "ros2msg", data: new Uint8Array() });
      channels.set(m.topic, await writer.registerChannel({ topic: m.topic, schemaId, messageEncoding: "cdr",
                                                           metadata: new Map() }));
    }
    await writer.addMessage({ channelId: channels.get(m.topic), sequence: sequence++, logTime: m.time,
                              publishTime: m.time, data: m.data });
  }
  await writer.end();
  fs.writeFileSync(name, Buffer.concat(writable.bytes));
}
const zstd = await new Promise((resolve) => zstdCodec.ZstdCodec.run((codec) => resolve(new codec.Simple())));
await write("none.mcap", {});
await write("zstd.mcap", { compressChunk: (bytes) => ({ compression: "zstd", compressedData: zstd.compress(bytes, 3) }) });
await write("lz4.mcap", { compressChunk: (bytes) => ({ compression: "lz4", compressedData: lz4.compress(bytes) }) });
await write("no_chunks.mcap", { useChunks: false });
await write("no_index.mcap", { useChunkIndex: false, useMessageIndex: false, useStatistics: false,
                               useSummaryOffsets: false, repeatChannels: false, repeatSchemas: false });
if (process.argv[2])
  fs.writeFileSync(process.argv[2], JSON.stringify(messages.map((m) => ({
    topic: m.topic, type: m.type, time: m.time.toString(), data: Buffer.from(m.data).toString("base64") }))));
