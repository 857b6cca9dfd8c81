// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "resight/io/internal/recording_topics.hpp"

namespace resight::io {

/// An image with the time of its header; that of the entry is when it was recorded.
struct StampedImage {
  MessageEntry entry;
  std::int64_t stamp_ns = 0;
};

/// A transform or pose with its topic.
struct ScannedTransform {
  int topic = -1;
  StampedTransform transform;
};

/// What is read of all messages when a recording is opened, in one pass: a chunk is decompressed once.
struct RecordingScan {
  std::vector<StampedImage> colors;
  std::vector<StampedImage> depths;
  std::vector<ScannedTransform> transforms;
  std::size_t num_images = 0;      ///< With the bad ones.
  std::size_t num_bad_images = 0;  ///< They cannot be decoded and are left out.
  std::size_t num_transform_messages = 0;
  std::size_t num_bad_transforms = 0;
  std::string damage;  ///< If a message could not be read, the reason: what lies behind it is left out.
};
inline constexpr std::size_t kMaxTransforms = 1U << 22;  ///< An hour of 100 frames at 10 Hz.
[[nodiscard]] RecordingScan scan_recording(const Recording& recording, const ViewTopics& topics,
                                           std::size_t max_transforms = kMaxTransforms);

/// A colour image and the depth image nearest in time.
struct RecordedPair {
  MessageEntry color;
  MessageEntry depth;
  std::int64_t depth_time_ns = 0;  ///< By which it was paired: of its header, or of recording.
};

struct RecordedPairs {
  std::vector<RecordedPair> pairs;  ///< In the order of time.
  bool by_recording_times = false;
};

/// Pairs the images by the times in their headers, in the order of time. If these do not fit together (clocks of two
/// devices), or most of them repeat, by the times of recording.
[[nodiscard]] RecordedPairs pair_images(const RecordingScan& scan, double max_difference_s);

}  // namespace resight::io
