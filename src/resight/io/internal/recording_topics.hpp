// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "resight/io/sequence.hpp"
#include "resight/recordings/message.hpp"
#include "resight/recordings/recording.hpp"

namespace resight::io {

/// The topics of a recording that make its views. Numbers are indices in Recording::topics().
struct ViewTopics {
  int color = -1;
  int depth = -1;
  std::string color_frame;
  std::string depth_frame;
  std::string depth_encoding;
  std::optional<CameraInfoMessage> color_info;
  std::optional<CameraInfoMessage> depth_info;
  std::string damage;  ///< Why the first message of a topic of images could not be read. It is not chosen.
};

/// Finds colour and depth by type, encoding and name, or takes those that are given, with their CameraInfo. The error
/// lists the topics to choose from.
[[nodiscard]] Result<ViewTopics> find_view_topics(const Recording& recording, const RecordingTopics& given);

/// Where the first message of each topic is, found in one pass. The recording must outlive it.
class FirstMessages {
 public:
  explicit FirstMessages(const Recording& recording);
  /// None if the topic has no messages.
  [[nodiscard]] Result<std::optional<std::string>> read(int topic, std::size_t max_bytes) const;

 private:
  const Recording& recording_;
  std::vector<const MessageEntry*> of_topic_;
};

/// Index of a topic by its name, or -1.
[[nodiscard]] int find_topic(const Recording& recording, std::string_view name);

}  // namespace resight::io
