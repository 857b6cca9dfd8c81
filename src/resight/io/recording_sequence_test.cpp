// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>
#include <opencv2/imgcodecs.hpp>

#include "resight/io/convert.hpp"
#include "resight/io/images.hpp"
#include "resight/io/internal/recording_images.hpp"
#include "resight/io/internal/test_data.hpp"
#include "resight/recordings/message.hpp"
#include "resight/recordings/testing/ros1_messages.hpp"

namespace resight {
namespace {

using testing::HasSubstr;

std::filesystem::path recorded(const std::string& name) {
  return std::filesystem::path(RESIGHT_SOURCE_DIR) / "tests/data/recordings" / name;
}

// The scene of tests/data/recordings/README.md.
TEST(RecordingSequence, ViewsOfAllContainers) {
  for (const char* name : {"none.bag", "lz4.bag", "bz2.bag", "none.mcap", "zstd.mcap", "lz4.mcap", "no_chunks.mcap",
                           "no_index.mcap", "ros2.db3", "ros2_zstd.db3"}) {
    const auto sequence = open_posed_sequence(recorded(name));
    ASSERT_TRUE(sequence.ok()) << sequence.error().message;
    ASSERT_EQ((*sequence)->num_views(), 4) << name;
    EXPECT_TRUE((*sequence)->has_poses());
    for (int i = 0; i < 4; ++i) {
      const auto frame = (*sequence)->read_view(i);
      ASSERT_TRUE(frame.ok()) << frame.error().message;
      EXPECT_EQ(frame->camera, (Camera{16, 12, 20, 21, 7.5, 5.5, find_depth_sensor("active-stereo")->noise}));
      EXPECT_EQ(frame->color(5, 2), (Rgb8{static_cast<std::uint8_t>(50 + i), 30, 100})) << name;
      EXPECT_NEAR(frame->depth_m(5, 2), 1.05 + 0.001 * i, 1e-6) << name;
      EXPECT_TRUE(std::isnan(frame->depth_m(0, 0)));
      // Camera x is to the right of the link, which looks along its x. Depth is 5 ms after colour.
      EXPECT_LT((frame->world_from_camera.translation - Eigen::Vector3d(0.1 * i + 0.005, 0.02, 0)).norm(), 1e-6);
      EXPECT_LT((frame->world_from_camera.rotation * Eigen::Vector3d::UnitZ() - Eigen::Vector3d::UnitX()).norm(), 1e-9);
    }
  }
}

TEST(RecordingSequence, ChoiceOfViews) {
  OpenSequenceOptions options;
  options.views.every = 2;
  const auto second = open_sequence(recorded("none.mcap"), options);
  ASSERT_TRUE(second.ok()) << second.error().message;
  EXPECT_EQ((*second)->num_views(), 2);
  EXPECT_EQ((*second)->view_name(1), "000002");
  options.views = {.every = 1, .from_s = 0.15, .to_s = 0.25, .max_views = {}};
  EXPECT_EQ((*open_sequence(recorded("none.mcap"), options))->num_views(), 1);
  // 0.1 and 0.2 s are no doubles.
  options.views = {.every = 1, .from_s = 0.1, .to_s = 0.2, .max_views = {}};
  EXPECT_EQ((*open_sequence(recorded("ros2.db3"), options))->num_views(), 2);
  options.views = {.every = 1, .from_s = 5, .to_s = {}, .max_views = {}};
  EXPECT_THAT(open_sequence(recorded("none.mcap"), options).error().message, HasSubstr("--from"));
}

TEST(RecordingSequence, TopicsAndFramesThatAreNotThere) {
  const auto message = [](const RecordingTopics& topics) {
    OpenSequenceOptions options;
    options.topics = topics;
    const auto sequence = open_sequence(recorded("none.bag"), options);
    return sequence.ok() ? std::string("no error") : sequence.error().message;
  };
  RecordingTopics topics;
  topics.color = "/nothing";
  EXPECT_THAT(message(topics), HasSubstr("topics of colour images: /camera/color/image_raw"));
  topics = {};
  topics.camera_info = "/nothing";
  EXPECT_THAT(message(topics), HasSubstr("no sensor_msgs/CameraInfo of the topic /nothing"));
  topics = {};
  topics.world_frame = "moon";
  EXPECT_THAT(message(topics), HasSubstr("frames: camera_color_optical_frame, camera_link, world"));
  topics = {};
  topics.max_time_difference_s = 0.001;
  EXPECT_THAT(message(topics), HasSubstr("--max-time-difference-ms"));
}

// A wall at 1 m (2000 units of 0.5 mm); the colour camera is 10 cm beside the depth camera, which is 2 px.
TEST(RecordingSequence, DepthOfLibrealsenseIsRegistered) {
  const auto sequence = open_sequence(recorded("realsense.bag"));
  ASSERT_TRUE(sequence.ok()) << sequence.error().message;
  EXPECT_FALSE((*sequence)->has_poses());
  ASSERT_EQ((*sequence)->num_views(), 2);
  const auto frame = (*sequence)->read_view(0);
  ASSERT_TRUE(frame.ok()) << frame.error().message;
  EXPECT_TRUE(std::isnan(frame->depth_m(0, 6)));
  EXPECT_TRUE(std::isnan(frame->depth_m(1, 6)));
  for (int u = 2; u < 16; ++u) EXPECT_NEAR(frame->depth_m(u, 6), 1.0, 1e-6) << u;
}

TEST(RecordingSequence, TheNoiseIsThatOfTheCameraThatItsNamesTell) {
  OpenSequenceOptions options;
  const auto noise_and_note = [&](const std::string& name) {
    const auto sequence = open_sequence(recorded(name), options);
    return std::pair((*sequence)->read_view(0)->camera.noise, (*sequence)->notes().back());
  };
  const auto [detected, note] = noise_and_note("realsense.bag");
  EXPECT_EQ(detected, find_depth_sensor("active-stereo")->noise);
  EXPECT_THAT(note, HasSubstr("depth noise of active-stereo (by the names in the recording; --sensor"));
  options.sensor = find_depth_sensor("time-of-flight");
  const auto [given, note_of_given] = noise_and_note("realsense.bag");
  EXPECT_EQ(given, options.sensor->noise);
  EXPECT_EQ(note_of_given, "depth noise of time-of-flight (--sensor)");
  options.sensor = find_depth_sensor("structured-light");
  EXPECT_EQ(noise_and_note("none.bag").first, DepthNoise{});
}

TEST(RecordingSequence, BecomesBop) {
  io::TestDirectory directory;
  const auto sequence = open_sequence(recorded("zstd.mcap"));
  ASSERT_TRUE(sequence.ok()) << sequence.error().message;
  ASSERT_TRUE(convert_sequence(**sequence, directory / "000001", DatasetFormat::kBop, {}).ok());
  const auto converted = open_posed_sequence(directory / "000001");
  ASSERT_TRUE(converted.ok()) << converted.error().message;
  ASSERT_EQ((*converted)->num_views(), 4);
  EXPECT_LT(io::pose_difference(*(*converted)->read_pose(3), *(*sequence)->read_pose(3)), 1e-9);
  EXPECT_EQ((*converted)->read_view(3)->color, (*sequence)->read_view(3)->color);
}

TEST(RecordingSequence, DamageIsTold) {
  io::TestDirectory directory;
  const std::string bytes = io::read_text(recorded("none.bag"));
  io::write_text(directory / "cut.bag", bytes.substr(0, bytes.size() * 3 / 5));
  const auto sequence = open_sequence(directory / "cut.bag");
  ASSERT_TRUE(sequence.ok()) << sequence.error().message;
  EXPECT_GE((*sequence)->num_views(), 2);
  EXPECT_THAT((*sequence)->notes(), testing::Contains(HasSubstr("damaged")));
  io::write_text(directory / "short.bag", bytes.substr(0, 4200));
  EXPECT_THAT(open_sequence(directory / "short.bag").error().message, HasSubstr("damaged"));
}

/// ---- Encodings of images, by messages that are put together here.

std::string little(std::uint32_t value) { return {reinterpret_cast<const char*>(&value), 4}; }

std::string raw_message(const std::string& encoding, int width, int height, int row_bytes, const std::string& data,
                        bool big_endian = false) {
  return little(0) + little(1) + little(2) + little(0) + little(static_cast<std::uint32_t>(height)) +
         little(static_cast<std::uint32_t>(width)) + little(static_cast<std::uint32_t>(encoding.size())) + encoding +
         std::string(1, big_endian ? '\1' : '\0') + little(static_cast<std::uint32_t>(row_bytes)) +
         little(static_cast<std::uint32_t>(data.size())) + data;
}

std::string compressed_message(const std::string& format, const std::string& data) {
  return little(0) + little(1) + little(2) + little(0) + little(static_cast<std::uint32_t>(format.size())) + format +
         little(static_cast<std::uint32_t>(data.size())) + data;
}

const RecordedTopic kRaw{"/camera/image", "sensor_msgs/Image", MessageLayout::kRos1};
const RecordedTopic kCompressed{"/camera/image", "sensor_msgs/CompressedImage", MessageLayout::kRos1};

TEST(RecordingImages, ColorEncodings) {
  const Rgb8 red{200, 10, 20};
  const auto pixel = [](const std::string& encoding, int bytes, const std::string& data) {
    const auto color =
        io::decode_color_message(raw_message(encoding, 2, 2, 2 * bytes, data + data + data + data), kRaw);
    EXPECT_TRUE(color.ok()) << color.error().message;
    return color.ok() ? (*color)(1, 1) : Rgb8{};
  };
  EXPECT_EQ(pixel("rgb8", 3, "\xc8\x0a\x14"), red);
  EXPECT_EQ(pixel("bgr8", 3, "\x14\x0a\xc8"), red);
  EXPECT_EQ(pixel("rgba8", 4, "\xc8\x0a\x14\xff"), red);
  EXPECT_EQ(pixel("bgra8", 4, "\x14\x0a\xc8\xff"), red);
  EXPECT_EQ(pixel("mono8", 1, "\x64"), (Rgb8{100, 100, 100}));
  const auto yuv = io::decode_color_message(raw_message("yuv422", 2, 2, 4, "\x80\x64\x80\x64\x80\x64\x80\x64"), kRaw);
  ASSERT_TRUE(yuv.ok()) << yuv.error().message;
  EXPECT_EQ((*yuv)(0, 0).r, (*yuv)(0, 0).b) << "grey";
  EXPECT_THAT(io::decode_color_message(raw_message("rgb8", 2, 2, 6, "123"), kRaw).error().message,
              HasSubstr("damaged"));
  EXPECT_THAT(io::decode_color_message(raw_message("rgb8", 2000000, 2000000, 6, "123"), kRaw).error().message,
              HasSubstr("out of range"));
  EXPECT_THAT(io::decode_color_message(raw_message("xyz", 2, 2, 6, "123"), kRaw).error().message,
              HasSubstr("'xyz' is not supported"));
}

TEST(RecordingImages, BayerPatterns) {
  // A red scene: only the red pixels of the pattern are bright.
  const auto red_share = [](const std::string& encoding, const std::vector<int>& red_at) {
    std::string data(64, '\0');
    for (int v = 0; v < 8; ++v)
      for (int u = 0; u < 8; ++u)
        if (u % 2 == red_at[0] && v % 2 == red_at[1]) data[static_cast<std::size_t>(8 * v + u)] = '\x78';
    const auto color = io::decode_color_message(raw_message(encoding, 8, 8, 8, data), kRaw);
    EXPECT_TRUE(color.ok()) << color.error().message;
    return color.ok() ? (*color)(4, 4) : Rgb8{};
  };
  EXPECT_EQ(red_share("bayer_rggb8", {0, 0}), (Rgb8{120, 0, 0}));
  EXPECT_EQ(red_share("bayer_bggr8", {1, 1}), (Rgb8{120, 0, 0}));
  EXPECT_EQ(red_share("bayer_gbrg8", {0, 1}), (Rgb8{120, 0, 0}));
  EXPECT_EQ(red_share("bayer_grbg8", {1, 0}), (Rgb8{120, 0, 0}));
}

// image_transport compresses the pattern as a grey picture, or the colours that it makes of it.
TEST(RecordingImages, CompressedBayerPatterns) {
  const auto decode = [](const cv::Mat& stored, const std::string& format) {
    std::vector<unsigned char> png;
    EXPECT_TRUE(cv::imencode(".png", stored, png));
    const auto color = io::decode_color_message(compressed_message(format, {png.begin(), png.end()}), kCompressed);
    EXPECT_TRUE(color.ok()) << color.error().message;
    return color.ok() ? (*color)(4, 4) : Rgb8{};
  };
  cv::Mat red(8, 8, CV_8UC1, cv::Scalar(0));
  for (int v = 0; v < 8; v += 2)
    for (int u = 0; u < 8; u += 2) red.at<unsigned char>(v, u) = 120;
  EXPECT_EQ(decode(red, "bayer_rggb8; png compressed "), (Rgb8{120, 0, 0}));
  EXPECT_EQ(decode(red, "mono8; png compressed "), (Rgb8{120, 120, 120}));
  const cv::Mat colors(8, 8, CV_8UC3, cv::Scalar(1, 2, 3));
  EXPECT_EQ(decode(colors, "bayer_rggb8; png compressed bgr8"), (Rgb8{3, 2, 1}));
}

TEST(RecordingImages, DepthEncodings) {
  const RecordedTopic topic{"/camera/depth", "sensor_msgs/Image", MessageLayout::kRos1};
  const auto millimetres = io::decode_depth_message(raw_message("16UC1", 2, 1, 4, "\xe8\x03\xff\xff"), topic, {});
  ASSERT_TRUE(millimetres.ok()) << millimetres.error().message;
  EXPECT_FLOAT_EQ((*millimetres)[0], 1.0F);
  EXPECT_TRUE(std::isnan((*millimetres)[1])) << "65535 is no return";
  EXPECT_TRUE(std::isnan((*io::decode_depth_message(raw_message("16UC1", 1, 1, 2, "\xe8\x03"), topic, 20.0))[0]));
  const auto swapped = io::decode_depth_message(raw_message("16UC1", 1, 1, 2, "\x03\xe8", true), topic, 0.0005);
  EXPECT_FLOAT_EQ((*swapped)[0], 0.5F);
  const float metres[] = {1.5F, std::nanf(""), 1e10F};
  const auto floats = io::decode_depth_message(
      raw_message("32FC1", 3, 1, 12, std::string(reinterpret_cast<const char*>(metres), 12)), topic, {});
  EXPECT_EQ((*floats)[0], 1.5F);
  EXPECT_TRUE(std::isnan((*floats)[1]));
  EXPECT_TRUE(std::isnan((*floats)[2])) << "finite, but absurd";
  EXPECT_EQ(io::content_of("mono16", "/device_0/sensor_0/Depth_0/image/data"), io::ImageContent::kDepth);
  EXPECT_EQ(io::content_of("mono16", "/camera/ir/image"), io::ImageContent::kUnknown);
  EXPECT_EQ(io::content_of("16UC1; compressedDepth png", "/d"), io::ImageContent::kDepth);
  EXPECT_EQ(io::content_of("rgb8; jpeg compressed bgr8", "/c"), io::ImageContent::kColor);
  EXPECT_EQ(io::content_of("16UC1; jpeg compressed ", "/c"), io::ImageContent::kUnknown);
}

TEST(RecordingImages, DepthOfDisparities) {
  const RecordedTopic topic{"/stereo/disparity", "stereo_msgs/DisparityImage", MessageLayout::kRos1};
  const float disparities_px[] = {50, 0.5F, 101, std::nanf("")};
  const auto message = [&](float focal_length_px) {
    return recordings::disparity_message(2.5, "left", focal_length_px, 0.05F, 2, 2,
                                         {reinterpret_cast<const char*>(disparities_px), sizeof(disparities_px)});
  };
  const auto depth_m = io::decode_depth_message(message(600), topic, {});
  ASSERT_TRUE(depth_m.ok()) << depth_m.error().message;
  EXPECT_NEAR((*depth_m)[0], 600 * 0.05 / 50, 1e-6);
  for (const std::size_t i : {1, 2, 3}) EXPECT_TRUE(std::isnan((*depth_m)[i])) << i;
  EXPECT_THAT(io::decode_depth_message(message(0), topic, {}).error().message, HasSubstr("without focal length"));
  const auto start = decode_image_start(message(600), topic);
  ASSERT_TRUE(start.ok());
  EXPECT_EQ(io::content_of(start->encoding, topic.name), io::ImageContent::kDepth);
  EXPECT_EQ(start->header.frame, "left");
  EXPECT_FALSE(io::decode_depth_message(message(600).substr(0, 90), topic, {}).ok());
}

TEST(RecordingImages, CompressedDepth) {
  io::TestDirectory directory;
  ASSERT_TRUE(write_depth(directory / "d.png", Image<float>(4, 3, 1.25F), 0.001).ok());
  const std::string png = io::read_text(directory / "d.png");
  const auto whole = io::decode_depth_message(
      compressed_message("16UC1; compressedDepth png", std::string(12, '\0') + png), kCompressed, {});
  ASSERT_TRUE(whole.ok()) << whole.error().message;
  EXPECT_FLOAT_EQ((*whole)(1, 1), 1.25F);
  // depth = a / (value - b) with a = 2500, b = -750: 2500 / (1250 + 750).
  const float parameters[] = {2500, -750};
  const auto metres = io::decode_depth_message(
      compressed_message("32FC1; compressedDepth",
                         std::string(4, '\0') + std::string(reinterpret_cast<const char*>(parameters), 8) + png),
      kCompressed, {});
  ASSERT_TRUE(metres.ok()) << metres.error().message;
  EXPECT_FLOAT_EQ((*metres)(1, 1), 1.25F);
  EXPECT_FALSE(
      io::decode_depth_message(compressed_message("16UC1; compressedDepth png", "short"), kCompressed, {}).ok());
}

}  // namespace
}  // namespace resight
