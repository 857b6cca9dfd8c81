// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "resight/core/result.hpp"
#include "resight/recordings/recording.hpp"

/// One reader per container format.
namespace resight::recordings {

using RecordingResult = Result<std::unique_ptr<Recording>>;

inline constexpr std::string_view kRos1BagMagic = "#ROSBAG V2.0\n";
inline constexpr std::string_view kMcapMagic = "\x89MCAP0\r\n";
inline constexpr std::string_view kSqliteMagic{"SQLite format 3\0", 16};

[[nodiscard]] RecordingResult open_ros1_bag(const std::filesystem::path& file);
[[nodiscard]] RecordingResult open_mcap(const std::filesystem::path& file);
[[nodiscard]] RecordingResult open_ros2_sqlite(const std::filesystem::path& file);

/// "sensor_msgs/msg/Image" -> "sensor_msgs/Image".
[[nodiscard]] std::string without_msg(std::string_view type);

/// What opening a file finds out.
struct RecordingIndex {
  std::vector<RecordedTopic> topics;
  std::vector<MessageEntry> messages;
  std::string damage;
};

/// A recording that is indexed when it is opened.
class IndexedRecording : public Recording {
 public:
  [[nodiscard]] const std::vector<RecordedTopic>& topics() const final { return index_.topics; }
  [[nodiscard]] const std::vector<MessageEntry>& messages() const final { return index_.messages; }
  [[nodiscard]] const std::string& damage() const final { return index_.damage; }

 protected:
  RecordingIndex index_;
};

}  // namespace resight::recordings
