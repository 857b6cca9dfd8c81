// SPDX-License-Identifier: Apache-2.0
#include "resight/recordings/recording.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sqlite3.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>

#include "resight/core/random.hpp"
#include "resight/recordings/internal/decompress.hpp"
#include "resight/recordings/message.hpp"
#include "resight/recordings/testing/ros1_messages.hpp"

namespace resight {
namespace {

using testing::HasSubstr;

namespace fs = std::filesystem;

/// Files that other programs have written (tests/data/recordings/README.md).
fs::path recorded(const std::string& name) { return fs::path(RESIGHT_SOURCE_DIR) / "tests/data/recordings" / name; }

const std::vector<std::string> kRos1 = {"none.bag", "lz4.bag", "bz2.bag"};
const std::vector<std::string> kRos2 = {"none.mcap",     "zstd.mcap", "lz4.mcap",     "no_chunks.mcap",
                                        "no_index.mcap", "ros2.db3",  "ros2_zstd.db3"};

std::vector<std::string> all_recordings() {
  std::vector<std::string> all = kRos1;
  all.insert(all.end(), kRos2.begin(), kRos2.end());
  return all;
}

std::string read_bytes(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// A file for the running test that is removed at its end.
class TemporaryFile {
 public:
  TemporaryFile() {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    path_ = fs::temp_directory_path() / fmt::format("resight_recordings_{}_{}", ::getpid(), test->name());
  }
  ~TemporaryFile() {
    std::error_code ignored;
    fs::remove(path_, ignored);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  const fs::path& write(const std::string& bytes) {
    std::ofstream(path_, std::ios::binary) << bytes;
    return path_;
  }

 private:
  fs::path path_;
};

/// All messages of a recording, in order; "" for those that cannot be read.
std::vector<std::string> read_all(const Recording& recording) {
  std::vector<std::string> all;
  for (const MessageEntry& entry : recording.messages()) {
    const auto bytes = recording.read(entry, kMaxMessageBytes);
    all.push_back(bytes.ok() ? *bytes : "");
  }
  return all;
}

std::map<std::string, int> count_messages(const Recording& recording) {
  std::map<std::string, int> counts;
  for (const MessageEntry& entry : recording.messages())
    ++counts[recording.topics()[static_cast<std::size_t>(entry.topic)].name];
  return counts;
}

TEST(Recording, FilesOfOtherWriters) {
  for (const std::string& name : all_recordings()) {
    const auto recording = open_recording(recorded(name));
    ASSERT_TRUE(recording.ok()) << recording.error().message;
    EXPECT_EQ((*recording)->damage(), "") << name;
    const std::map<std::string, int> expected = {{"/camera/aligned_depth_to_color/image_raw", 4},
                                                 {"/camera/color/camera_info", 1},
                                                 {"/camera/color/image_raw", 4},
                                                 {"/tf", 5},
                                                 {"/tf_static", 1}};
    EXPECT_EQ(count_messages(**recording), expected) << name;
  }
}

TEST(Recording, SameContentInAllContainers) {
  for (const auto& names : {kRos1, kRos2}) {
    const auto first = read_all(**open_recording(recorded(names.front())));
    for (const std::string& name : names) {
      auto other = read_all(**open_recording(recorded(name)));
      EXPECT_EQ(other.size(), first.size());
      EXPECT_TRUE(std::ranges::is_permutation(other, first)) << name;
    }
  }
}

TEST(Recording, MessagesAreDecoded) {
  for (const std::string& name : all_recordings()) {
    const auto recording = open_recording(recorded(name));
    ASSERT_TRUE(recording.ok()) << recording.error().message;
    int num_images = 0;
    for (const MessageEntry& entry : (*recording)->messages()) {
      const RecordedTopic& topic = (*recording)->topics()[static_cast<std::size_t>(entry.topic)];
      const auto bytes = (*recording)->read(entry, kMaxMessageBytes);
      ASSERT_TRUE(bytes.ok()) << bytes.error().message;
      if (topic.name == "/camera/color/image_raw") {
        const auto image = decode_image(*bytes, topic.layout, topic.name);
        ASSERT_TRUE(image.ok()) << name << image.error().message;
        EXPECT_EQ(image->width, 16U);
        EXPECT_EQ(image->height, 12U);
        EXPECT_EQ(image->encoding, "rgb8");
        EXPECT_EQ(image->header.frame, "camera_color_optical_frame");
        ASSERT_EQ(image->data.size(), 3U * 16 * 12);
        const auto index = (image->header.stamp_ns - 100000000000 + 50000000) / 100000000;
        EXPECT_EQ(static_cast<unsigned char>(image->data[3 * (2 * 16 + 5)]), 50 + index) << name;
        ++num_images;
      }
      if (topic.name == "/camera/color/camera_info") {
        const auto info = decode_camera_info(*bytes, topic.layout, topic.name);
        ASSERT_TRUE(info.ok()) << name << info.error().message;
        EXPECT_EQ(info->k[4], 21.0);
        EXPECT_EQ(info->p[2], 7.5);
        EXPECT_EQ(info->distortion.size(), 5U);
      }
      if (topic.name == "/tf") {
        const auto transforms = decode_transforms(*bytes, topic);
        ASSERT_TRUE(transforms.ok()) << name << transforms.error().message;
        ASSERT_EQ(transforms->size(), 1U);
        EXPECT_EQ(transforms->front().child, "camera_link");
        const double seconds = static_cast<double>(transforms->front().stamp_ns) * 1e-9 - 100;
        EXPECT_NEAR(transforms->front().parent_from_child.translation.x(), seconds, 1e-6);
      }
    }
    EXPECT_EQ(num_images, 4);
  }
}

TEST(Recording, EverythingBeforeACutIsRead) {
  TemporaryFile file;
  for (const char* name : {"none.bag", "lz4.bag", "none.mcap", "zstd.mcap", "no_chunks.mcap"}) {
    const std::string bytes = read_bytes(recorded(name));
    const auto whole = read_all(**open_recording(recorded(name)));
    std::size_t largest = 0;
    const std::size_t step = std::max<std::size_t>(1, bytes.size() / 400);
    for (std::size_t cut = 0; cut < bytes.size(); cut += step) {
      const auto recording = open_recording(file.write(bytes.substr(0, cut)));
      if (!recording) {
        EXPECT_FALSE(recording.error().message.empty());
        continue;
      }
      const auto left = read_all(**recording);
      ASSERT_LE(left.size(), whole.size()) << name << " " << cut;
      EXPECT_GE(left.size(), largest) << name << ": a longer file must not hold less, cut at " << cut;
      largest = std::max(largest, left.size());
      // The scan meets messages in the order of the file; an index may list them by topic.
      for (const std::string& message : left) ASSERT_TRUE(std::ranges::count(whole, message) > 0) << name << " " << cut;
    }
    EXPECT_GT(largest, whole.size() / 2) << name;
  }
}

/// Messages of a topic, as another reader counts them.
struct TopicSummary {
  std::int64_t count = 0, bytes = 0, first_ns = 0, last_ns = 0;
  friend bool operator==(const TopicSummary&, const TopicSummary&) = default;
};

std::map<std::string, TopicSummary> summarize(const Recording& recording) {
  std::map<std::string, TopicSummary> topics;
  for (const MessageEntry& entry : recording.messages()) {
    TopicSummary& topic = topics[recording.topics()[static_cast<std::size_t>(entry.topic)].name];
    topic.first_ns = topic.count == 0 ? entry.time_ns : std::min(topic.first_ns, entry.time_ns);
    topic.last_ns = topic.count == 0 ? entry.time_ns : std::max(topic.last_ns, entry.time_ns);
    ++topic.count;
    topic.bytes += static_cast<std::int64_t>(recording.read(entry, kMaxMessageBytes)->size());
  }
  return topics;
}

/// bag_messages.txt is what @foxglove/rosbag reads (read_bags.mjs).
TEST(Recording, AgreesWithAnotherReader) {
  std::map<std::string, std::map<std::string, TopicSummary>> expected;
  std::ifstream list(recorded("bag_messages.txt"));
  std::string bag, topic;
  TopicSummary summary;
  while (list >> bag >> topic >> summary.count >> summary.bytes >> summary.first_ns >> summary.last_ns)
    expected[bag][topic] = summary;
  ASSERT_EQ(expected.size(), 4U);
  for (const auto& [name, topics] : expected) {
    const auto recording = open_recording(recorded(name));
    ASSERT_TRUE(recording.ok()) << recording.error().message;
    EXPECT_EQ(summarize(**recording), topics) << name;
  }
}

TEST(Recording, CutsAreNamed) {
  TemporaryFile file;
  const std::string bytes = read_bytes(recorded("none.bag"));
  const auto recording = open_recording(file.write(bytes.substr(0, 20000)));
  ASSERT_TRUE(recording.ok()) << recording.error().message;
  EXPECT_THAT((*recording)->damage(), HasSubstr("cut off"));
  EXPECT_GT((*recording)->messages().size(), 2U);
}

TEST(Recording, AnUncompressedChunkIsReadUpToTheCut) {
  // All messages lie in one chunk.
  TemporaryFile file;
  const std::string bytes = read_bytes(recorded("none.mcap"));
  const auto whole = read_all(**open_recording(recorded("none.mcap")));
  const auto recording = open_recording(file.write(bytes.substr(0, bytes.size() / 2)));
  ASSERT_TRUE(recording.ok()) << recording.error().message;
  EXPECT_THAT((*recording)->damage(), HasSubstr("ends within the record"));
  EXPECT_GT((*recording)->messages().size(), 3U);
  EXPECT_LT((*recording)->messages().size(), whole.size());
}

TEST(Recording, MissingPartsAreNamed) {
  const fs::path folder = fs::temp_directory_path() / fmt::format("resight_recordings_{}_MissingParts", ::getpid());
  fs::remove_all(folder);
  fs::create_directories(folder);
  fs::copy(recorded("ros2.db3"), folder / "bag_0.db3");
  const auto write_metadata = [&](const std::string& files) {
    std::ofstream(folder / "metadata.yaml") << "rosbag2_bagfile_information:\n  version: 5\n  relative_file_paths:\n"
                                            << files << "  duration:\n    nanoseconds: 1\n";
  };
  write_metadata("    - bag_0.db3\n");
  EXPECT_EQ((*open_recording(folder))->damage(), "");
  write_metadata("    - bag_0.db3\n    - \"bag_1.db3\"\n");
  const auto recording = open_recording(folder);
  ASSERT_TRUE(recording.ok()) << recording.error().message;
  EXPECT_THAT((*recording)->damage(), HasSubstr("1 of the files of metadata.yaml is missing (bag_1.db3)"));
  EXPECT_FALSE((*recording)->messages().empty());
  std::ofstream(folder / "metadata.yaml") << "a:\n  relative_file_paths:";
  EXPECT_EQ((*open_recording(folder))->damage(), "");
  fs::remove_all(folder);
}

TEST(Recording, ABagThatWasNotClosedIsRefused) {
  const fs::path folder = fs::temp_directory_path() / fmt::format("resight_recordings_{}_NotClosed", ::getpid());
  fs::remove_all(folder);
  fs::create_directories(folder);
  fs::copy(recorded("ros2.db3"), folder / "bag_0.db3");
  std::ofstream(folder / "bag_0.db3-wal") << "";
  EXPECT_TRUE(open_recording(folder / "bag_0.db3").ok()) << "an empty log holds nothing";
  std::ofstream(folder / "bag_0.db3-wal") << "the last messages";
  for (const fs::path& where : {folder, folder / "bag_0.db3"})
    EXPECT_THAT(open_recording(where).error().message, HasSubstr("bag_0.db3: was not closed"));
  fs::remove_all(folder);
}

std::string mcap_record(int op, const std::string& content) {
  return recordings::packed(static_cast<std::uint8_t>(op)) +
         recordings::packed(static_cast<std::uint64_t>(content.size())) + content;
}

std::string mcap_chunk(const std::string& records) {
  std::string content(16, '\0');  // first and last time
  content += recordings::packed(static_cast<std::uint64_t>(records.size())) + std::string(8, '\0');
  content += recordings::packed(static_cast<std::uint64_t>(records.size())) + records;
  return mcap_record(6, content);
}

std::string mcap_chunk_index(std::size_t begin, std::size_t bytes, std::size_t index_bytes) {
  std::string content(16, '\0');
  content += recordings::packed(std::uint64_t{begin}) + recordings::packed(std::uint64_t{bytes});
  content += recordings::packed_text(std::string(10, '\0')) + recordings::packed(std::uint64_t{index_bytes});
  return mcap_record(8, content);
}

// A message in a chunk, at whose end lies a chunk with the same index behind it. A file of such chunks would take a
// time that grows with the square of its size.
TEST(Recording, ChunksOfMcapWithinEachOtherAreNotIndexed) {
  const std::string channel = recordings::packed(std::uint16_t{1});
  const std::string lists = mcap_record(3, channel + recordings::packed_text("std_msgs/String") +
                                               recordings::packed_text("ros1msg") + recordings::packed_text("")) +
                            mcap_record(4, channel + channel + recordings::packed_text("/a") +
                                               recordings::packed_text("ros1") + recordings::packed(std::uint32_t{0}));
  const std::string message = mcap_record(5, channel + std::string(20, '\0') + "hello");
  const std::string inner = mcap_chunk(message);
  const std::string outer = mcap_chunk(lists + message + inner);
  const std::string index = mcap_record(7, channel + recordings::packed_text(std::string(16, '\0')));
  std::string bytes("\x89MCAP0\r\n", 8);
  const std::size_t outer_begin = bytes.size();
  bytes += outer + index;
  const std::size_t inner_begin = outer_begin + outer.size() - inner.size();
  bytes += mcap_record(15, std::string(4, '\0'));
  const std::string summary = recordings::packed(std::uint64_t{bytes.size()});
  bytes += lists + mcap_chunk_index(outer_begin, outer.size(), index.size()) +
           mcap_chunk_index(inner_begin, inner.size(), index.size());
  bytes += mcap_record(2, summary + std::string(12, '\0')) + std::string("\x89MCAP0\r\n", 8);
  TemporaryFile file;
  const auto recording = open_recording(file.write(bytes));
  ASSERT_TRUE(recording.ok()) << recording.error().message;
  EXPECT_EQ((*recording)->damage(), "") << "the whole file is read instead of its list of chunks";
  ASSERT_EQ((*recording)->messages().size(), 1U);
  EXPECT_EQ(*(*recording)->read((*recording)->messages().front(), kMaxMessageBytes), "hello");
}

std::string bag_field(const std::string& name, const std::string& value) {
  return recordings::packed_text(name + "=" + value);
}

std::string bag_record(char op, const std::string& fields, const std::string& data) {
  return recordings::packed_text(bag_field("op", std::string(1, op)) + fields) + recordings::packed_text(data);
}

std::string bag_chunk(const std::string& records) {
  const auto size = static_cast<std::uint32_t>(records.size());
  return bag_record('\5', bag_field("compression", "none") + bag_field("size", recordings::packed(size)), records);
}

std::string bag_header(std::size_t index_begin) {
  return bag_record('\3',
                    bag_field("index_pos", recordings::packed(std::uint64_t{index_begin})) +
                        bag_field("conn_count", recordings::packed(std::uint32_t{1})) +
                        bag_field("chunk_count", recordings::packed(std::uint32_t{2})),
                    "");
}

TEST(Recording, ChunksOfBagsWithinEachOtherAreNotIndexed) {
  const std::string number = bag_field("conn", recordings::packed(std::uint32_t{0}));
  const std::string connection =
      bag_record('\7', number + bag_field("topic", "/a"), bag_field("type", "std_msgs/String"));
  const std::string message = bag_record('\2', number + bag_field("time", std::string(8, '\0')), "hello");
  const std::string inner = bag_chunk(message);
  const std::string outer = bag_chunk(connection + message + inner);
  const std::string index = bag_record('\4', number, std::string(12, '\0'));
  const std::string magic = "#ROSBAG V2.0\n";
  const std::size_t outer_begin = magic.size() + bag_header(0).size();
  const std::size_t inner_begin = outer_begin + outer.size() - inner.size();
  std::string bytes = magic + bag_header(outer_begin + outer.size() + index.size()) + outer + index + connection;
  for (const std::size_t begin : {outer_begin, inner_begin})
    bytes += bag_record('\6', bag_field("chunk_pos", recordings::packed(std::uint64_t{begin})), "");
  TemporaryFile file;
  const auto recording = open_recording(file.write(bytes));
  ASSERT_TRUE(recording.ok()) << recording.error().message;
  EXPECT_EQ((*recording)->damage(), "") << "the whole file is read instead of its index";
  ASSERT_EQ((*recording)->messages().size(), 1U);
  EXPECT_EQ(*(*recording)->read((*recording)->messages().front(), kMaxMessageBytes), "hello");
}

TEST(Recording, LongNamesAreRefused) {
  const std::string name(2000, 'a');
  TemporaryFile file;
  for (const bool is_topic : {false, true}) {
    recordings::TestRecording mcap;
    mcap.add(is_topic ? name : "/a", is_topic ? "std_msgs/String" : name, 1, "hello");
    const auto recording = open_recording(file.write(mcap.bytes()));
    ASSERT_TRUE(recording.ok()) << recording.error().message;
    EXPECT_THAT((*recording)->damage(), HasSubstr("2000 bytes"));
    EXPECT_TRUE((*recording)->topics().empty());

    const std::string number = bag_field("conn", recordings::packed(std::uint32_t{0}));
    const std::string connection = bag_record('\7', number + bag_field("topic", is_topic ? name : "/a"),
                                              bag_field("type", is_topic ? "std_msgs/String" : name));
    const auto bag = open_recording(file.write("#ROSBAG V2.0\n" + bag_header(0) + connection));
    ASSERT_TRUE(bag.ok()) << bag.error().message;
    EXPECT_THAT((*bag)->damage(), HasSubstr("2000 bytes"));
    EXPECT_TRUE((*bag)->topics().empty());
  }
}

TEST(Recording, ChunksThatDeclareFarMoreThanTheFileHoldsAreRefused) {
  TemporaryFile file;
  const auto declared = recordings::packed(std::uint32_t{200'000'000});
  const std::string bag =
      "#ROSBAG V2.0\n" + bag_header(0) +
      bag_record('\5', bag_field("compression", "bz2") + bag_field("size", declared), std::string(300, 'x'));
  EXPECT_THAT((*open_recording(file.write(bag)))->damage(), HasSubstr("its chunks declare 200000000 bytes"));
  const std::string chunk = mcap_record(6, std::string(16, '\0') + recordings::packed(std::uint64_t{200'000'000}) +
                                               recordings::packed(std::uint32_t{0}) + recordings::packed_text("zstd") +
                                               recordings::packed(std::uint64_t{300}) + std::string(300, 'x'));
  EXPECT_THAT((*open_recording(file.write("\x89MCAP0\r\n" + chunk)))->damage(),
              HasSubstr("its chunks declare 200000000 bytes"));
}

// A copy of a bag, whose ids are neither unique nor an index: each message is found by its row.
TEST(Recording, MessagesOfADatabaseNeedNoIndexOfTheirIds) {
  TemporaryFile file;
  const fs::path& path = file.write("");
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(path.c_str(), &database), SQLITE_OK);
  const char* sql =
      "CREATE TABLE topics(id INTEGER, name TEXT, type TEXT, serialization_format TEXT);"
      "CREATE TABLE messages(id INTEGER, topic_id INTEGER, timestamp INTEGER, data BLOB);"
      "INSERT INTO topics VALUES(1, '/a', 'std_msgs/msg/String', 'cdr');"
      "INSERT INTO messages VALUES(7, 1, 10, x'0102'), (7, 1, 11, x'030405');";
  ASSERT_EQ(sqlite3_exec(database, sql, nullptr, nullptr, nullptr), SQLITE_OK);
  sqlite3_close(database);
  const auto recording = open_recording(path);
  ASSERT_TRUE(recording.ok()) << recording.error().message;
  EXPECT_EQ(read_all(**recording), (std::vector<std::string>{"\1\2", "\3\4\5"}));
  EXPECT_EQ(*(*recording)->read((*recording)->messages()[1], 2), "\3\4");
}

/// Every file with bytes exchanged is refused or read.
TEST(Recording, SurvivesDamage) {
  TemporaryFile file;
  Rng rng(7);
  for (const std::string& name : all_recordings()) {
    const std::string bytes = read_bytes(recorded(name));
    int num_opened = 0;
    for (int i = 0; i < 150; ++i) {
      std::string damaged = bytes;
      const int count = 1 + static_cast<int>(rng.below(4));
      for (int k = 0; k < count; ++k) {
        const std::size_t at = rng.below(static_cast<std::uint32_t>(bytes.size()));
        damaged[at] = static_cast<char>(rng.below(2) == 0 ? 0xFF : rng.below(256));
      }
      const auto recording = open_recording(file.write(damaged));
      if (!recording) {
        EXPECT_FALSE(recording.error().message.empty());
        continue;
      }
      ++num_opened;
      for (const MessageEntry& entry : (*recording)->messages()) {
        const auto message = (*recording)->read(entry, kMaxMessageBytes);
        if (!message) continue;
        const RecordedTopic& topic = (*recording)->topics()[static_cast<std::size_t>(entry.topic)];
        (void)decode_image(*message, topic.layout, "x");
        (void)decode_camera_info(*message, topic.layout, "x");
        (void)decode_transforms(*message, topic);
      }
    }
    EXPECT_GT(num_opened, 20) << name;
  }
}

TEST(Recording, MessagesThatAreCutAreErrors) {
  const auto recording = open_recording(recorded("none.mcap"));
  ASSERT_TRUE(recording.ok()) << recording.error().message;
  for (const MessageEntry& entry : (*recording)->messages()) {
    const RecordedTopic& topic = (*recording)->topics()[static_cast<std::size_t>(entry.topic)];
    const std::string bytes = *(*recording)->read(entry, kMaxMessageBytes);
    for (std::size_t cut = 0; cut < bytes.size(); cut += 1 + bytes.size() / 100) {
      const std::string part = bytes.substr(0, cut);
      const bool is_read = topic.type == "sensor_msgs/Image" ? decode_image(part, topic.layout, "x").ok()
                           : topic.type == "sensor_msgs/CameraInfo"
                               ? cut < 100 && decode_camera_info(part, topic.layout, "x").ok()  // its end is not needed
                               : decode_transforms(part, topic).ok();
      EXPECT_FALSE(is_read) << topic.type << " cut at " << cut;
    }
  }
}

TEST(Recording, RefusesOtherFiles) {
  TemporaryFile file;
  EXPECT_FALSE(is_recording(file.write("hello")));
  EXPECT_THAT(open_recording(file.write("hello")).error().message, HasSubstr("is no recording"));
  EXPECT_THAT(open_recording(file.write("#ROSBAG V1.2\n")).error().message, HasSubstr("rosbag fix"));
  EXPECT_FALSE(open_recording("/nowhere").ok());
  EXPECT_TRUE(is_recording(recorded("none.bag")));
  EXPECT_TRUE(is_recording(recorded("ros2.db3")));
}

TEST(Decompress, DeclaredSizesAreBounded) {
  EXPECT_THAT(recordings::decompress("lz4", "", std::uint64_t{1} << 40).error().message, HasSubstr("declares"));
  EXPECT_THAT(recordings::decompress("xz", "", 10).error().message, HasSubstr("'xz' is not supported"));
  for (const char* compression : {"lz4", "bz2", "zstd"}) {
    EXPECT_FALSE(recordings::decompress(compression, "", 10).ok()) << compression;
    EXPECT_FALSE(recordings::decompress(compression, "nonsense", 10).ok()) << compression;
  }
}

}  // namespace
}  // namespace resight
