// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "resight/core/crc32.hpp"
#include "resight/core/random.hpp"
#include "resight/recordings/internal/decompress.hpp"
#include "resight/recordings/message.hpp"
#include "resight/recordings/recording.hpp"
#include "resight/recordings/recording_test_util.hpp"
#include "resight/recordings/testing/ros1_messages.hpp"

/// Recordings that are cut off, incomplete, damaged or made to do harm.
namespace resight {
namespace {

using testing::HasSubstr;
using namespace test;

TEST(RecordingDamage, EverythingBeforeACutIsRead) {
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

TEST(RecordingDamage, CutsAreNamed) {
  TemporaryFile file;
  const std::string bytes = read_bytes(recorded("none.bag"));
  const auto recording = open_recording(file.write(bytes.substr(0, 20000)));
  ASSERT_TRUE(recording.ok()) << recording.error().message;
  EXPECT_THAT((*recording)->damage(), HasSubstr("cut off"));
  EXPECT_GT((*recording)->messages().size(), 2U);
}

TEST(RecordingDamage, AnUncompressedChunkIsReadUpToTheCut) {
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

// SQLite itself finds damage only where it looks.
TEST(RecordingDamage, DatabasesThatAreCutOffAreNamedOrRefused) {
  TemporaryFile file;
  for (const char* name : {"ros2.db3", "ros2_zstd.db3"}) {
    const std::string bytes = read_bytes(recorded(name));
    EXPECT_EQ((*open_recording(file.write(bytes)))->damage(), "") << name;
    int num_opened = 0;
    for (std::size_t lost = 1; lost < bytes.size(); lost += 97) {
      const auto recording = open_recording(file.write(bytes.substr(0, bytes.size() - lost)));
      if (!recording) continue;
      ++num_opened;
      EXPECT_FALSE((*recording)->damage().empty()) << name << " without its last " << lost << " bytes";
    }
    EXPECT_GT(num_opened, 10) << name;
  }
}

TEST(RecordingDamage, MessagesOfADatabaseWithoutTopicAreCounted) {
  TemporaryFile file;
  std::string bytes = read_bytes(recorded("ros2.db3"));
  std::fill(bytes.begin() + 22118, bytes.end(), '\0');  // the last page, with the numbers of topics
  const auto recording = open_recording(file.write(bytes));
  ASSERT_TRUE(recording.ok()) << recording.error().message;
  EXPECT_THAT((*recording)->damage(), HasSubstr("4 of its messages belong to no topic"));
  EXPECT_EQ((*recording)->messages().size(), 11U);
  std::fill(bytes.begin() + 16384, bytes.begin() + 20480, '\0');  // a page of the tree
  EXPECT_THAT((*open_recording(file.write(bytes)))->damage(), HasSubstr("malformed"));
}

TEST(RecordingDamage, MissingPartsAreNamed) {
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
  // As rosbag2 leaves them whose files are compressed as a whole, before and after they are unpacked.
  write_metadata("    - bag_0.db3.zstd\n    - bag_1.db3.zstd\n");
  std::ofstream(folder / "bag_1.db3.zstd") << "x";
  EXPECT_THAT((*open_recording(folder))->damage(), "bag_1.db3.zstd is compressed; unpack it with zstd -d");
  fs::remove(folder / "bag_1.db3.zstd");
  // As a recorder leaves the last one that was killed.
  std::ofstream(folder / "bag_1.db3") << "";
  const auto with_empty = open_recording(folder);
  ASSERT_TRUE(with_empty.ok()) << with_empty.error().message;
  EXPECT_THAT((*with_empty)->damage(), "bag_1.db3 is empty");
  EXPECT_EQ((*with_empty)->messages().size(), (*recording)->messages().size());
  fs::remove(folder / "bag_1.db3");
  std::ofstream(folder / "metadata.yaml") << "a:\n  relative_file_paths:";
  EXPECT_EQ((*open_recording(folder))->damage(), "");
  fs::remove_all(folder);
}

TEST(RecordingDamage, ABagThatWasNotClosedIsRefused) {
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

std::string mcap_chunk(const std::string& records, std::uint32_t crc = 0) {
  std::string content(16, '\0');  // first and last time
  content += recordings::packed(static_cast<std::uint64_t>(records.size())) + recordings::packed(crc);
  content += recordings::packed_text("");  // not compressed
  content += recordings::packed(static_cast<std::uint64_t>(records.size())) + records;
  return mcap_record(6, content);
}

std::string mcap_chunk_index(std::size_t begin, std::size_t bytes, std::size_t index_bytes) {
  std::string content(16, '\0');
  content += recordings::packed(std::uint64_t{begin}) + recordings::packed(std::uint64_t{bytes});
  content += recordings::packed_text(std::string(10, '\0')) + recordings::packed(std::uint64_t{index_bytes});
  return mcap_record(8, content);
}

const std::string kMcapChannel = recordings::packed(std::uint16_t{1});

/// Of one channel, with its schema.
std::string mcap_lists() {
  return mcap_record(3, kMcapChannel + recordings::packed_text("std_msgs/String") + recordings::packed_text("ros1msg") +
                            recordings::packed_text("")) +
         mcap_record(4, kMcapChannel + kMcapChannel + recordings::packed_text("/a") + recordings::packed_text("ros1") +
                            recordings::packed(std::uint32_t{0}));
}

std::string mcap_message(const std::string& text) {
  return mcap_record(5, kMcapChannel + std::string(20, '\0') + text);
}

/// Of a chunk that begins with a message.
std::string mcap_index_of_one() {
  return mcap_record(7, kMcapChannel + recordings::packed_text(std::string(16, '\0')));
}

/// A file whose summary lists only this chunk of one message. The other records lie around it.
std::string mcap_of_chunk(const std::string& before, const std::string& chunk, const std::string& after) {
  const std::string magic("\x89MCAP0\r\n", 8);
  std::string bytes = magic + before;
  const std::size_t begin = bytes.size();
  bytes += chunk + mcap_index_of_one() + after + mcap_record(15, std::string(4, '\0'));
  const std::string summary = recordings::packed(std::uint64_t{bytes.size()});
  bytes += mcap_lists() + mcap_chunk_index(begin, chunk.size(), mcap_index_of_one().size());
  return bytes + mcap_record(2, summary + std::string(12, '\0')) + magic;
}

TEST(RecordingDamage, UncompressedChunksWithAWrongChecksumAreNotRead) {
  const std::string message = mcap_message("hello");
  for (const std::uint32_t damage : {0U, 1U}) {
    TemporaryFile file;
    const std::string chunk = mcap_chunk(message, compute_crc32(message) ^ damage);
    const auto recording = open_recording(file.write(mcap_of_chunk("", chunk, "")));
    ASSERT_TRUE(recording.ok()) << recording.error().message;
    ASSERT_EQ((*recording)->messages().size(), 1U);
    const auto read = (*recording)->read((*recording)->messages().front(), kMaxMessageBytes);
    EXPECT_EQ(read.ok() ? *read : read.error().message.substr(read.error().message.rfind('(')),
              damage == 0 ? "hello" : "(its checksum does not match)");
  }
}

TEST(RecordingDamage, WhatLiesBesideTheListedChunksIsRead) {
  TemporaryFile file;
  const auto recording = open_recording(file.write(
      mcap_of_chunk(mcap_record(1, std::string(8, '\0')) + mcap_message("first"), mcap_chunk(mcap_message("second")),
                    mcap_message("third") + mcap_chunk(mcap_message("fourth")) + mcap_index_of_one())));
  ASSERT_TRUE(recording.ok()) << recording.error().message;
  EXPECT_EQ((*recording)->damage(), "");
  EXPECT_THAT(read_all(**recording), testing::UnorderedElementsAre("first", "second", "third", "fourth"));
}

// A message in a chunk, at whose end lies a chunk with the same index behind it. A file of such chunks would take a
// time that grows with the square of its size.
TEST(RecordingDamage, ChunksOfMcapWithinEachOtherAreNotIndexed) {
  const std::string lists = mcap_lists();
  const std::string message = mcap_message("hello");
  const std::string inner = mcap_chunk(message);
  const std::string outer = mcap_chunk(lists + message + inner);
  const std::string index = mcap_index_of_one();
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

TEST(RecordingDamage, ChunksOfBagsWithinEachOtherAreNotIndexed) {
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

TEST(RecordingDamage, LongNamesAreRefused) {
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

TEST(RecordingDamage, ChunksThatDeclareFarMoreThanTheFileHoldsAreRefused) {
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
/// Every file with bytes exchanged is refused or read.
TEST(RecordingDamage, SurvivesDamage) {
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

TEST(RecordingDamage, MessagesThatAreCutAreErrors) {
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
