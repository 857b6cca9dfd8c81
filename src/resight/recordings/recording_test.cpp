// SPDX-License-Identifier: Apache-2.0
#include "resight/recordings/recording.hpp"

#include <gmock/gmock.h>
#include <sqlite3.h>

#include <algorithm>
#include <fstream>
#include <map>

#include "resight/recordings/message.hpp"
#include "resight/recordings/recording_test_util.hpp"

namespace resight {
namespace {

using testing::HasSubstr;
using namespace test;

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

TEST(Recording, RefusesOtherFiles) {
  TemporaryFile file;
  EXPECT_FALSE(is_recording(file.write("hello")));
  EXPECT_THAT(open_recording(file.write("hello")).error().message, HasSubstr("is no recording"));
  EXPECT_THAT(open_recording(file.write("#ROSBAG V1.2\n")).error().message, HasSubstr("rosbag fix"));
  EXPECT_FALSE(open_recording("/nowhere").ok());
  EXPECT_TRUE(is_recording(recorded("none.bag")));
  EXPECT_TRUE(is_recording(recorded("ros2.db3")));
}

TEST(Recording, AFolderIsABagByWhatItsMetadataSays) {
  const fs::path folder = fs::temp_directory_path() / fmt::format("resight_recordings_{}_Metadata", ::getpid());
  fs::remove_all(folder);
  fs::create_directories(folder);
  std::ofstream(folder / "metadata.yaml") << "camera: realsense\n";
  EXPECT_FALSE(is_recording(folder));
  std::ofstream(folder / "bag_0.db3.zstd") << "x";
  EXPECT_TRUE(is_recording(folder));
  fs::remove(folder / "bag_0.db3.zstd");
  std::ofstream(folder / "metadata.yaml") << "rosbag2_bagfile_information:\n  version: 5\n";
  EXPECT_TRUE(is_recording(folder)) << "it can be said what it lacks";
  fs::remove_all(folder);
}

}  // namespace
}  // namespace resight
