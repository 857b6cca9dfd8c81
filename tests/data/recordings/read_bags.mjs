// Prints what @foxglove/rosbag reads in the ROS 1 bags of a folder: name of the bag, topic, messages, the sum of their
// bytes, and the first and last time in ns. Our reader must find the same (recording_test.cpp).
//   npm install @foxglove/rosbag@0.4.1 @foxglove/wasm-bz2@0.3.0 @foxglove/wasm-lz4@1.0.2
//   node read_bags.mjs FOLDER >messages.txt
import { readdirSync } from "node:fs";
import rosbag from "@foxglove/rosbag";
import { FileReader } from "@foxglove/rosbag/node.js";
import bz2 from "@foxglove/wasm-bz2";
import lz4 from "@foxglove/wasm-lz4";

const folder = process.argv[2];
const files = readdirSync(folder).filter((name) => name.endsWith(".bag")).sort();
const Bzip2 = bz2.default ?? bz2;
const Lz4 = lz4.default ?? lz4;
const unbz2 = await Bzip2.init();
await Lz4.isLoaded;
for (const name of files) {
  const bag = new rosbag.Bag(new FileReader(`${folder}/${name}`), {
    decompress: {
      bz2: (buffer, size) => unbz2.decompress(buffer, size, { small: false }),
      lz4: (buffer, size) => Lz4(buffer, size),
    },
    parse: false,
  });
  await bag.open();
  const topics = new Map();
  for await (const { topic, data, timestamp } of bag.messageIterator()) {
    const time_ns = BigInt(timestamp.sec) * 1000000000n + BigInt(timestamp.nsec);
    const seen = topics.get(topic) ?? { count: 0, bytes: 0, first: time_ns, last: time_ns };
    topics.set(topic, { count: seen.count + 1, bytes: seen.bytes + data.byteLength, first: seen.first, last: time_ns });
  }
  for (const [topic, t] of [...topics].sort()) console.log(name, topic, t.count, t.bytes, String(t.first), String(t.last));
}
