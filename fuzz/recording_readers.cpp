// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "reader.hpp"
#include "resight/io/internal/sequences.hpp"
#include "resight/recordings/internal/decompress.hpp"
#include "resight/recordings/message.hpp"
#include "resight/recordings/recording.hpp"
#include "resight/recordings/testing/ros1_messages.hpp"

namespace resight::fuzz {
namespace {

namespace fs = std::filesystem;
using Seeds = std::vector<std::string>;

void replace_all(std::string& text, std::string_view from, std::string_view to) {
  for (std::size_t at = text.find(from); at != text.npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
}

/// They declare the smallest blocks of bz2 and lz4, for which the decoders allocate the least: fuzzing is faster.
Seeds stored_recordings(std::initializer_list<const char*> names) {
  Seeds seeds;
  for (const char* name : names) {
    seeds.push_back(source_file("tests/data/recordings/" + std::string(name)));
    replace_all(seeds.back(), "BZh9", "BZh1");
    replace_all(seeds.back(), "\x04\x22\x4d\x18\x40\x70\xdf", "\x04\x22\x4d\x18\x40\x40\xc0");
  }
  return seeds;
}

/// Opens a recording, and reads its first messages.
void read_messages(const fs::path& file) {
  const auto recording = open_recording(file);
  if (!recording) return;
  const auto& messages = (*recording)->messages();
  const std::size_t count = std::min<std::size_t>(messages.size(), 20);
  for (std::size_t i = 0; i < count; ++i) (void)(*recording)->read(messages[i], kMaxMessageBytes);
}
std::function<void(std::string_view)> container_reader(const char* name) {
  return [name](std::string_view bytes) { read_messages(write_scratch(name, bytes)); };
}

/// Colour, depth, their cameras and a moving frame.
Seeds make_sequence_seeds() {
  using namespace recordings;
  TestRecording recording;
  const std::vector<double> k = {10, 0, 4, 0, 10, 3, 0, 0, 1};
  for (const char* topic : {"/color/camera_info", "/depth/camera_info"})
    recording.add(topic, "sensor_msgs/CameraInfo", 1,
                  camera_info_message("camera", 8, 6, "plumb_bob", {0.1, 0, 0, 0, 0}, k));
  for (const double time_s : {1.0, 1.1}) {
    Rigid3 pose;
    pose.translation.x() = time_s;
    recording.add("/tf", "tf2_msgs/TFMessage", time_s, transform_message(time_s, "world", "camera", pose));
    recording.add("/color/image_raw", "sensor_msgs/Image", time_s,
                  image_message(time_s, "camera", "rgb8", 8, 6, std::string(8 * 6 * 3, 'x')));
    recording.add("/depth/image_raw", "sensor_msgs/Image", time_s,
                  image_message(time_s, "camera", "16UC1", 8, 6, std::string(8 * 6 * 2, '\4')));
  }
  return {recording.bytes()};
}
void read_sequence(std::string_view bytes) {
  const auto sequence = io::open_recording_sequence(write_scratch("sequence.mcap", bytes), {});
  if (sequence && (*sequence)->num_views() > 1) (void)(*sequence)->read_view(1);
}

/// The first byte chooses the type.
Seeds make_message_seeds() {
  using namespace recordings;
  return {'\0' + image_message(1, "camera", "rgb8", 2, 2, std::string(12, 'x')),
          '\2' + packed_header(1, "camera") + packed_text("jpeg") + packed_text("data"),
          '\4' + camera_info_message("camera", 8, 6, "plumb_bob", {0.1, 0, 0, 0, 0}, {10, 0, 4, 0, 10, 3, 0, 0, 1}),
          '\6' + transform_message(1, "world", "camera", {}),
          '\x8' + odometry_message(1, "odom", "base", {}),
          '\xa' + pose_message(1, "world", {}),
          '\xc' + packed_rigid({}),
          '\xe' + packed(1.5F),
          std::string("\x5\0\1\0\0\1\0\0\0\2\0\0\0\4\0\0\0cam\0\6\0\0\0\x8\0\0\0", 28) + std::string(300, '\0')};
}
void read_message(std::string_view bytes) {
  if (bytes.empty()) return;
  const MessageLayout layout = (bytes[0] & 1) != 0 ? MessageLayout::kCdr : MessageLayout::kRos1;
  const int type = (bytes[0] >> 1) & 7;
  bytes.remove_prefix(1);
  const auto transforms = [&](const char* name) { (void)decode_transforms(bytes, {"/topic", name, layout}); };
  if (type == 0) (void)decode_image(bytes, layout, "fuzz");
  if (type == 1) (void)decode_compressed_image(bytes, layout, "fuzz");
  if (type == 2) (void)decode_camera_info(bytes, layout, "fuzz");
  if (type == 3) transforms("tf2_msgs/TFMessage");
  if (type == 4) transforms("nav_msgs/Odometry");
  if (type == 5) transforms("geometry_msgs/PoseStamped");
  if (type == 6) (void)decode_plain_transform(bytes, layout, "fuzz");
  if (type == 7) (void)decode_float(bytes, layout, "fuzz");
}

/// The first byte chooses the compression; the two after it are the size.
Seeds make_compressed_seeds() {
  const std::string lz4("\x04\x22\x4d\x18\x40\x40\xc0\x05\x00\x00\x80hello\x00\x00\x00\x00", 20);
  const std::string zstd("\x28\xb5\x2f\xfd\x20\x05\x29\x00\x00hello", 14);
  return {std::string("\0\5\0", 3) + lz4, std::string("\2\5\0", 3) + zstd,
          std::string("\1\0\0BZh9\x17\x72\x45\x38\x50\x90\0\0\0\0", 17)};
}
void read_compressed(std::string_view bytes) {
  if (bytes.size() < 3) return;
  const char* const compression = bytes[0] == 0 ? "lz4" : bytes[0] == 1 ? "bz2" : "zstd";
  const auto size = static_cast<std::uint64_t>(static_cast<unsigned char>(bytes[1])) +
                    (static_cast<std::uint64_t>(static_cast<unsigned char>(bytes[2])) << 8);
  (void)recordings::decompress(compression, bytes.substr(3), size);
}

}  // namespace

std::vector<FuzzReader> recording_readers() {
  return {
      {"rosbag",
       [] {
         return stored_recordings({"bz2.bag", "lz4.bag", "none.bag", "realsense.bag"});
       },
       container_reader("recording.bag"), 300},
      {"mcap",
       [] {
         Seeds seeds = stored_recordings({"lz4.mcap", "no_chunks.mcap", "no_index.mcap", "none.mcap", "zstd.mcap"});
         seeds.push_back(make_sequence_seeds()[0]);
         return seeds;
       },
       container_reader("recording.mcap"), 500},
      {"ros2_sqlite", [] { return stored_recordings({"ros2.db3"}); }, container_reader("recording.db3"), 300},
      {"recording_sequence", make_sequence_seeds, read_sequence, 500},
      {"message", make_message_seeds, read_message},
      {"decompress", make_compressed_seeds, read_compressed},
  };
}

}  // namespace resight::fuzz
