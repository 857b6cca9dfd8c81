// SPDX-License-Identifier: Apache-2.0
#include "resight/recordings/recording.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

#include "resight/core/files.hpp"
#include "resight/core/input_file.hpp"
#include "resight/core/printable.hpp"
#include "resight/recordings/internal/containers.hpp"

namespace resight {
namespace recordings {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMaxMetadataBytes = 1U << 20;

/// A ROS 2 bag of several files, one after the other.
class SplitRecording final : public IndexedRecording {
 public:
  void add(std::unique_ptr<Recording> part) {
    if (!index_.damage.empty()) return;
    std::vector<int> topic_of_part;
    for (const RecordedTopic& topic : part->topics()) {
      const auto number = index_.add_topic(topic);
      if (!number) {
        index_.damage = number.error().message;
        return;
      }
      topic_of_part.push_back(*number);
    }
    for (const MessageEntry& message : part->messages()) {
      MessageEntry entry = message;
      entry.topic = topic_of_part[static_cast<std::size_t>(message.topic)];
      entry.part = static_cast<std::uint32_t>(parts_.size());
      entry.offset = places_in_part_.size();
      places_in_part_.push_back(message);
      index_.messages.push_back(entry);
    }
    index_.damage = part->damage();
    parts_.push_back(std::move(part));
  }
  /// After the last part: no part is added to a damaged recording.
  void add_damage(const std::string& text) { index_.damage += (index_.damage.empty() ? "" : "; ") + text; }
  [[nodiscard]] bool is_empty() const { return parts_.empty(); }
  [[nodiscard]] std::string format() const override { return parts_.front()->format(); }
  [[nodiscard]] Result<std::string> read(const MessageEntry& entry, std::size_t max_bytes) const override {
    return parts_.at(entry.part)->read(places_in_part_.at(entry.offset), max_bytes);
  }

 private:
  std::vector<std::unique_ptr<Recording>> parts_;
  std::vector<MessageEntry> places_in_part_;  ///< The entry of each message in its part.
};

RecordingResult open_file(const fs::path& file) {
  const auto start = read_file_start(file, kSqliteMagic.size());
  if (!start) return start.error();
  if (start->starts_with(kRos1BagMagic)) return open_ros1_bag(file);
  if (start->starts_with("#ROSBAG V1") || start->starts_with("#ROSRECORD"))
    return file_error(file, "is a bag of an old version; rosbag fix converts it to version 2.0");
  if (start->starts_with(kMcapMagic)) return open_mcap(file);
  if (*start == kSqliteMagic) return open_ros2_sqlite(file);
  return file_error(file, "is no recording (expected a ROS 1 bag 2.0, an MCAP file or a ROS 2 bag)");
}

bool is_part_name(const fs::path& name) { return name.extension() == ".db3" || name.extension() == ".mcap"; }

/// The parts of a ROS 2 bag, in the order of their numbers.
std::vector<fs::path> list_parts(const fs::path& folder) {
  std::vector<fs::path> parts;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    std::error_code ignored;
    if (is_part_name(it->path()) && it->is_regular_file(ignored)) parts.push_back(it->path());
  }
  // Of equal length: name_9 precedes name_10.
  std::ranges::sort(parts, [](const fs::path& a, const fs::path& b) {
    return a.native().size() != b.native().size() ? a.native().size() < b.native().size() : a < b;
  });
  return parts;
}

/// The parts that metadata.yaml of a ROS 2 bag names, but which are not there.
std::vector<std::string> list_missing_parts(const fs::path& folder) {
  std::vector<std::string> missing;
  const auto text = read_file(folder / "metadata.yaml", kMaxMetadataBytes);
  constexpr std::string_view kKey = "relative_file_paths:";
  const std::size_t list = text.ok() ? text->find(kKey) : std::string::npos;
  if (list == std::string::npos) return missing;
  std::istringstream lines(text->substr(list + kKey.size()));
  std::string line;
  std::getline(lines, line);  // the rest of the line of the key
  while (std::getline(lines, line)) {
    const std::size_t dash = line.find_first_not_of(' ');
    if (dash == std::string::npos || line[dash] != '-') break;
    const std::size_t begin = line.find_first_not_of(" \"'\r", dash + 1);
    if (begin == std::string::npos) continue;
    const std::string name = line.substr(begin, line.find_last_not_of(" \"'\r") + 1 - begin);
    std::error_code ignored;
    fs::path file = folder / fs::path(name).filename();
    const bool is_there = fs::exists(file, ignored);
    if (!is_there && (file.extension() != ".zstd" || !fs::exists(file.replace_extension(), ignored)))
      missing.push_back(name);
  }
  return missing;
}

/// The parts that are compressed as a whole and were not unpacked.
std::vector<std::string> list_packed_parts(const fs::path& folder) {
  std::vector<std::string> packed;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    std::error_code ignored;
    const fs::path unpacked = fs::path(it->path()).replace_extension();
    if (it->path().extension() == ".zstd" && is_part_name(unpacked) && !fs::exists(unpacked, ignored))
      packed.push_back(it->path().filename().string());
  }
  std::ranges::sort(packed);
  return packed;
}

/// Other programs write a metadata.yaml, too.
bool has_bag_metadata(const fs::path& folder) {
  const auto text = read_file(folder / "metadata.yaml", kMaxMetadataBytes);
  return text.ok() && text->find("rosbag2_bagfile_information") != std::string::npos;
}

}  // namespace

std::string without_msg(std::string_view type) {
  const std::size_t middle = type.find("/msg/");
  if (middle == type.npos) return std::string(type);
  return std::string(type.substr(0, middle)) + std::string(type.substr(middle + 4));
}

Result<void> check_name(std::string_view name) {
  if (name.size() <= kMaxNameBytes) return {};
  return Error{fmt::format("the name of a topic or type has {} bytes (at most {})", name.size(), kMaxNameBytes)};
}

Result<int> RecordingIndex::add_topic(RecordedTopic topic) {
  for (const std::string& name : {topic.name, topic.type})
    if (const auto done = check_name(name); !done) return done.error();
  const std::pair key(topic.name, topic.type);
  if (const auto found = numbers_.find(key); found != numbers_.end()) return found->second;
  if (topics.size() >= kMaxTopics) return Error{fmt::format("holds more than {} topics", kMaxTopics)};
  const int number = static_cast<int>(topics.size());
  numbers_.emplace(key, number);
  topics.push_back(std::move(topic));
  return number;
}

Result<void> ChunkSizes::add(std::uint64_t size) {
  if (size > kMaxChunkBytes) return Error{fmt::format("a chunk declares {} bytes (at most {})", size, kMaxChunkBytes)};
  sum_ += size;
  if (sum_ <= max_sum_) return {};
  return Error{fmt::format("its chunks declare {} bytes, far more than such a file can hold", sum_)};
}

}  // namespace recordings

bool is_recording(const std::filesystem::path& where) {
  std::error_code error;
  if (std::filesystem::is_directory(where, error)) {
    return !recordings::list_parts(where).empty() || !recordings::list_packed_parts(where).empty() ||
           recordings::has_bag_metadata(where);
  }
  const auto start = read_file_start(where, recordings::kSqliteMagic.size());
  return start.ok() && (start->starts_with("#ROSBAG") || start->starts_with("#ROSRECORD") ||
                        start->starts_with(recordings::kMcapMagic) || *start == recordings::kSqliteMagic);
}

Result<std::unique_ptr<Recording>> open_recording(const std::filesystem::path& where) {
  std::error_code error;
  if (!std::filesystem::is_directory(where, error)) return recordings::open_file(where);
  const auto parts = recordings::list_parts(where);
  const std::vector<std::string> packed = recordings::list_packed_parts(where);
  if (parts.empty())
    return file_error(where, packed.empty() ? "holds no *.db3 or *.mcap"
                                            : "its files are compressed as a whole; unpack them with zstd -d");
  const std::vector<std::string> missing = recordings::list_missing_parts(where);
  if (parts.size() == 1 && missing.empty() && packed.empty()) return recordings::open_file(parts.front());
  auto split = std::make_unique<recordings::SplitRecording>();
  std::string empty;
  for (const auto& part : parts) {
    if (std::filesystem::is_empty(part, error)) {  // as a recorder that was killed leaves it
      empty = printable(part.filename().string());
      continue;
    }
    auto opened = recordings::open_file(part);
    if (!opened) return opened.error();
    split->add(std::move(*opened));
  }
  if (split->is_empty()) return file_error(where, "its files are empty");
  if (!packed.empty())
    split->add_damage(fmt::format("{} is compressed; unpack it with zstd -d", printable(packed.front())));
  if (!empty.empty()) split->add_damage(empty + " is empty");
  if (!missing.empty())
    split->add_damage(fmt::format("{} of the files of metadata.yaml {} missing ({})", missing.size(),
                                  missing.size() == 1 ? "is" : "are", printable(missing.front())));
  return Result<std::unique_ptr<Recording>>(std::move(split));
}

}  // namespace resight
