// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
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

/// Fails if the name of a topic or of a type is too long to be kept.
[[nodiscard]] Result<void> check_name(std::string_view name);

/// What opening a file finds out.
struct RecordingIndex {
  /// The number of the topic with this name and type, which is added if it is new. The error does not name the file.
  [[nodiscard]] Result<int> add_topic(RecordedTopic topic);
  std::vector<RecordedTopic> topics;
  std::vector<MessageEntry> messages;
  std::string damage;

 private:
  std::map<std::pair<std::string, std::string>, int> numbers_;
};

/// The uncompressed sizes that the chunks of a file declare. Together, they are bounded by the size of the file: no
/// camera's images are a thousand times smaller when they are compressed.
class ChunkSizes {
 public:
  explicit ChunkSizes(std::uint64_t file_bytes) : max_sum_(kFreeBytes + kMaxRatio * file_bytes) {}
  /// The error does not name the file.
  [[nodiscard]] Result<void> add(std::uint64_t size);
  void clear() { sum_ = 0; }

 private:
  static constexpr std::uint64_t kFreeBytes = std::uint64_t{16} << 20;
  static constexpr std::uint64_t kMaxRatio = 1000;
  std::uint64_t max_sum_;
  std::uint64_t sum_ = 0;
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
