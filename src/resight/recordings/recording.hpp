// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "resight/core/result.hpp"

namespace resight {

/// How the bytes of a message are laid out.
enum class MessageLayout : std::uint8_t {
  kRos1,   ///< Packed, little-endian.
  kCdr,    ///< ROS 2: aligned, behind 4 bytes that tell the byte order.
  kOther,  ///< Not read.
};

/// A stream of messages of one type.
struct RecordedTopic {
  std::string name;
  std::string type;  ///< Such as "sensor_msgs/Image"; the "/msg/" of ROS 2 is left out.
  MessageLayout layout = MessageLayout::kOther;
};

/// One message, not yet read.
struct MessageEntry {
  std::int64_t time_ns = 0;  ///< When it was recorded.
  int topic = 0;             ///< Index in Recording::topics().
  std::uint32_t part = 0;    ///< Chunk or file that holds the message.
  std::uint64_t offset = 0;  ///< In the part (the number of the row in a database).
};

/// A file of recorded messages. Opening reads an index; messages are read when asked for. Const functions may be called
/// from several threads.
class Recording {
 public:
  virtual ~Recording() = default;
  [[nodiscard]] virtual std::string format() const = 0;  ///< "rosbag", "mcap" or "rosbag2-sqlite3".
  [[nodiscard]] virtual const std::vector<RecordedTopic>& topics() const = 0;
  /// In the order in which they lie in the file.
  [[nodiscard]] virtual const std::vector<MessageEntry>& messages() const = 0;
  /// The bytes of a message, at most `max_bytes` of them.
  [[nodiscard]] virtual Result<std::string> read(const MessageEntry& entry, std::size_t max_bytes) const = 0;
  /// What is damaged, if opening met a damaged place: messages() are those before it. Empty if nothing is.
  [[nodiscard]] virtual const std::string& damage() const = 0;
};

/// Limits for what a file declares.
inline constexpr std::uint64_t kMaxMessageBytes = std::uint64_t{1} << 28;
inline constexpr std::uint64_t kMaxChunkBytes = std::uint64_t{1} << 28;  ///< Uncompressed.
inline constexpr std::size_t kMaxMessages = std::size_t{1} << 24;
inline constexpr std::size_t kMaxTopics = 10000;
inline constexpr std::size_t kMaxNameBytes = 1024;  ///< Of a topic and of a type.

/// Whether a file (by its first bytes) or a folder (by metadata.yaml, *.db3 or *.mcap in it) is a recording.
[[nodiscard]] bool is_recording(const std::filesystem::path& where);

/// Opens a ROS 1 bag (2.0), an MCAP file, a ROS 2 bag (*.db3), or a folder with the parts of a ROS 2 bag.
[[nodiscard]] Result<std::unique_ptr<Recording>> open_recording(const std::filesystem::path& where);

}  // namespace resight
