// SPDX-License-Identifier: Apache-2.0
#include "resight/io/internal/recording_scan.hpp"

#include <fmt/format.h>

#include <set>
#include <utility>

#include "resight/io/internal/time_pairs.hpp"

namespace resight::io {
namespace {

using StampOf = std::int64_t (*)(const StampedImage&);
std::int64_t header_stamp(const StampedImage& image) { return image.stamp_ns; }
std::int64_t recorded_stamp(const StampedImage& image) { return image.entry.time_ns; }

std::vector<double> times_of(const std::vector<StampedImage>& images, StampOf stamp_of) {
  std::vector<double> times_s;
  for (const StampedImage& image : images) times_s.push_back(static_cast<double>(stamp_of(image)) * 1e-9);
  return times_s;
}

std::vector<RecordedPair> pair_by(StampOf stamp_of, const RecordingScan& scan, double max_difference_s) {
  std::vector<RecordedPair> pairs;
  const auto found = pair_by_time(times_of(scan.colors, stamp_of), times_of(scan.depths, stamp_of), max_difference_s);
  for (const TimePair& pair : found) {
    const StampedImage& depth = scan.depths[pair.depth];
    pairs.push_back({scan.colors[pair.color].entry, depth.entry, stamp_of(depth)});
  }
  return pairs;
}

/// Whether most images share the time of their header with others: it is unset, or tells whole seconds.
bool headers_repeat(const std::vector<StampedImage>& images) {
  std::set<std::int64_t> stamps_ns;
  for (const StampedImage& image : images) stamps_ns.insert(image.stamp_ns);
  return stamps_ns.size() * 2 < images.size();
}

}  // namespace

RecordingScan scan_recording(const Recording& recording, const ViewTopics& topics, std::size_t max_transforms) {
  constexpr std::size_t kMaxTransformBytes = 1U << 20;
  RecordingScan scan;
  for (const MessageEntry& entry : recording.messages()) {
    const RecordedTopic& topic = recording.topics()[static_cast<std::size_t>(entry.topic)];
    const bool is_image = entry.topic == topics.color || entry.topic == topics.depth;
    if (!is_image && !holds_transforms(topic.type)) continue;
    if (!is_image && scan.transforms.size() > max_transforms) {  // Images may have poses of a file.
      scan.damage = fmt::format("holds more than {} transforms; those behind them are left out", max_transforms);
      continue;
    }
    const auto bytes = recording.read(entry, is_image ? kImageStartBytes : kMaxTransformBytes);
    if (!bytes) {
      scan.damage = bytes.error().message;
      break;
    }
    ++(is_image ? scan.num_images : scan.num_transform_messages);
    if (is_image) {
      const auto start = decode_image_start(*bytes, topic);
      if (!start) {
        ++scan.num_bad_images;
        continue;
      }
      (entry.topic == topics.color ? scan.colors : scan.depths).push_back({entry, start->header.stamp_ns});
    } else if (const auto transforms = decode_transforms(*bytes, topic)) {
      for (const StampedTransform& transform : *transforms) scan.transforms.push_back({entry.topic, transform});
    } else {
      ++scan.num_bad_transforms;
    }
  }
  return scan;
}

RecordedPairs pair_images(const RecordingScan& scan, double max_difference_s) {
  auto by_header = pair_by(&header_stamp, scan, max_difference_s);
  auto by_recording = pair_by(&recorded_stamp, scan, max_difference_s);
  const bool clocks_differ = by_header.size() * 4 < by_recording.size();
  const bool prefers_recording = clocks_differ || headers_repeat(scan.colors) || headers_repeat(scan.depths);
  return {prefers_recording ? std::move(by_recording) : std::move(by_header), prefers_recording};
}

}  // namespace resight::io
