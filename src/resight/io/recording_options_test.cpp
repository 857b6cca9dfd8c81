// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>

#include "resight/io/internal/recording_scan.hpp"
#include "resight/io/internal/test_data.hpp"
#include "resight/recordings/testing/ros1_messages.hpp"

/// What recordings may hold and lack, with files that the test writes.
namespace resight {
namespace {

using recordings::TestRecording;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

constexpr int kImageWidth = 20;
constexpr int kImageHeight = 10;
const std::vector<double> kIntrinsics = {30, 0, 9.5, 0, 30, 4.5, 0, 0, 1};

struct TopicsOfTest {
  std::string color = "/rgb/image_raw";
  std::string depth = "/depth/image_raw";
  std::string color_frame = "camera";
  std::string depth_frame = "camera";
};

/// Three views of a wall at 1 m, at 10.0, 10.1 and 10.2 s.
void add_views(TestRecording& recording, const TopicsOfTest& topics) {
  const std::string color(3 * kImageWidth * kImageHeight, '\x50');
  std::string depth;
  for (int i = 0; i < kImageWidth * kImageHeight; ++i) depth += recordings::packed(std::uint16_t{1000});
  for (int i = 0; i < 3; ++i) {
    const double time_s = 10 + 0.1 * i;
    recording.add(topics.color, "sensor_msgs/Image", time_s,
                  recordings::image_message(time_s, topics.color_frame, "bgr8", kImageWidth, kImageHeight, color));
    recording.add(topics.depth, "sensor_msgs/Image", time_s,
                  recordings::image_message(time_s, topics.depth_frame, "16UC1", kImageWidth, kImageHeight, depth));
  }
}

void add_info(TestRecording& recording, const std::string& topic, const std::vector<double>& distortion = {},
              const std::string& model = "plumb_bob") {
  recording.add(topic, "sensor_msgs/CameraInfo", 9,
                recordings::camera_info_message("camera", kImageWidth, kImageHeight, model, distortion, kIntrinsics));
}

/// Topics of images with a message each. Counts how often somebody asks for the list of messages.
class CountingRecording final : public Recording {
 public:
  explicit CountingRecording(int num_topics) {
    for (int t = 0; t < num_topics; ++t) {
      topics_.push_back({"/camera" + std::to_string(t), "sensor_msgs/Image", MessageLayout::kRos1});
      messages_.push_back({.topic = t});
    }
  }
  [[nodiscard]] std::string format() const override { return "mcap"; }
  [[nodiscard]] const std::vector<RecordedTopic>& topics() const override { return topics_; }
  [[nodiscard]] const std::vector<MessageEntry>& messages() const override {
    ++num_lists;
    return messages_;
  }
  [[nodiscard]] Result<std::string> read(const MessageEntry& /*entry*/, std::size_t /*max_bytes*/) const override {
    return recordings::image_message(1, "camera", "bgr8", 1, 1, "rgb");
  }
  [[nodiscard]] const std::string& damage() const override { return damage_; }
  mutable int num_lists = 0;

 private:
  std::vector<RecordedTopic> topics_;
  std::vector<MessageEntry> messages_;
  std::string damage_;
};

// The list of messages may be long.
TEST(RecordingTopics, FirstMessagesAreFoundInOnePass) {
  const CountingRecording recording(50);
  EXPECT_THAT(io::find_view_topics(recording, {}).error().message, HasSubstr("several topics of colour images"));
  EXPECT_EQ(recording.num_lists, 1);
}

class RecordingOptions : public testing::Test {
 protected:
  Result<std::unique_ptr<Sequence>> open(const OpenSequenceOptions& options = {}) {
    io::write_text(directory_ / "r.mcap", recording_.bytes());
    return open_sequence(directory_ / "r.mcap", options);
  }
  std::string error(const OpenSequenceOptions& options = {}) {
    const auto sequence = open(options);
    return sequence.ok() ? std::string("no error") : sequence.error().message;
  }
  TestRecording recording_;
  io::TestDirectory directory_;
};

TEST_F(RecordingOptions, NoCameraInfoNeedsIntrinsics) {
  add_views(recording_, {});
  EXPECT_THAT(error(), HasSubstr("no sensor_msgs/CameraInfo for /rgb/image_raw"));
  OpenSequenceOptions options;
  options.intrinsics = "30,30,9.5,4.5";
  const auto sequence = open(options);
  ASSERT_TRUE(sequence.ok()) << sequence.error().message;
  EXPECT_EQ((*sequence)->read_view(0)->camera, (Camera{kImageWidth, kImageHeight, 30, 30, 9.5, 4.5}));
  EXPECT_FALSE((*sequence)->has_poses());
  options.poses = "fixed";
  EXPECT_TRUE((*open(options))->has_poses());
  io::write_text(directory_ / "k.yaml", "fx: 30\nfy: 30\ncx: 9.5\ncy: 4.5\ndepth_scale: 0.0002\n");
  options.intrinsics = (directory_ / "k.yaml").string();
  EXPECT_THAT((*open(options))->notes(), Contains(HasSubstr("the unit of depth in k.yaml (0.0002 m) is not used")));
}

TEST_F(RecordingOptions, PosesOfAFileByTime) {
  add_views(recording_, {});
  add_info(recording_, "/rgb/camera_info");
  io::write_text(directory_ / "poses.txt", "10.0 0 0 0 0 0 0 1\n10.1 0 0 2 0 0 0 1\n");
  OpenSequenceOptions options;
  options.poses = (directory_ / "poses.txt").string();
  const auto sequence = open(options);
  ASSERT_TRUE(sequence.ok()) << sequence.error().message;
  ASSERT_EQ((*sequence)->num_views(), 2) << "the third is too late";
  EXPECT_NEAR((*sequence)->read_pose(1)->translation.z(), 2, 1e-6);
  EXPECT_THAT((*sequence)->notes(), Contains(HasSubstr("1 of 3 views have no pose")));
}

TEST_F(RecordingOptions, MessagesThatCannotBeDecodedAreCounted) {
  add_views(recording_, {});
  add_info(recording_, "/rgb/camera_info");
  EXPECT_THAT((*open())->notes(), Not(Contains(HasSubstr("cannot be decoded"))));
  recording_.add("/rgb/image_raw", "sensor_msgs/Image", 10.3, "short");
  recording_.add("/depth/image_raw", "sensor_msgs/Image", 10.3, "");
  recording_.add("/tf", "tf2_msgs/TFMessage", 10.3, "many");
  const auto sequence = open();
  ASSERT_TRUE(sequence.ok()) << sequence.error().message;
  EXPECT_EQ((*sequence)->num_views(), 3);
  EXPECT_THAT((*sequence)->notes(), Contains("2 of 8 images cannot be decoded and are left out"));
  EXPECT_THAT((*sequence)->notes(), Contains("1 of 1 messages with transforms cannot be decoded and are left out"));
}

// Drivers leave the times in the headers unset, or write whole seconds. The first colour image has no depth.
TEST_F(RecordingOptions, ImagesWhoseHeadersRepeatArePairedByTheTimesOfRecording) {
  for (const double second : {0.0, 10.0}) {
    recording_ = TestRecording();
    add_info(recording_, "/rgb/camera_info");
    for (int i = 0; i < 4; ++i) {
      const double time_s = 10 + 0.1 * i;
      recording_.add(
          "/tf", "tf2_msgs/TFMessage", time_s,
          recordings::transform_message(time_s, "world", "camera", Rigid3::from_translation({time_s, 0, 0})));
      const std::string color(3 * kImageWidth * kImageHeight, static_cast<char>('0' + i));
      recording_.add("/rgb/image_raw", "sensor_msgs/Image", time_s,
                     recordings::image_message(second, "camera", "bgr8", kImageWidth, kImageHeight, color));
      std::string depth;
      for (int p = 0; p < kImageWidth * kImageHeight; ++p)
        depth += recordings::packed(static_cast<std::uint16_t>(1000 + 100 * i));
      if (i > 0)
        recording_.add("/depth/image_raw", "sensor_msgs/Image", time_s + 0.004,
                       recordings::image_message(second, "camera", "16UC1", kImageWidth, kImageHeight, depth));
    }
    const auto sequence = open();
    ASSERT_TRUE(sequence.ok()) << sequence.error().message;
    ASSERT_EQ((*sequence)->num_views(), 3);
    for (int v = 0; v < 3; ++v) {
      const auto frame = (*sequence)->read_view(v);
      ASSERT_TRUE(frame.ok()) << frame.error().message;
      EXPECT_EQ(frame->color(1, 1).r, '1' + v);
      EXPECT_NEAR(frame->depth_m(1, 1), 1.1 + 0.1 * v, 1e-6);
      EXPECT_NEAR(frame->world_from_camera.translation.x(), std::min(10.104 + 0.1 * v, 10.3), 1e-6);
    }
    EXPECT_THAT((*sequence)->notes(), Contains(HasSubstr("paired by the times of recording")));
  }
}

TEST_F(RecordingOptions, OdometryAndPoses) {
  TestRecording odometry;
  TestRecording poses;
  for (TestRecording* recording : {&odometry, &poses}) {
    add_views(*recording, {});
    add_info(*recording, "/rgb/camera_info");
    recording->add("/tf_static", "tf2_msgs/TFMessage", 9,
                   recordings::transform_message(9, "base", "camera", Rigid3::from_translation({0, 0, 1})));
    for (int i = 0; i < 4; ++i) {
      const double time_s = 10 + 0.1 * i;
      const Rigid3 pose = Rigid3::from_translation({0.5 * i, 0, 0});
      if (recording == &odometry)
        recording->add("/odom", "nav_msgs/Odometry", time_s,
                       recordings::odometry_message(time_s, "odom", "base", pose));
      else
        recording->add("/pose", "geometry_msgs/PoseStamped", time_s, recordings::pose_message(time_s, "world", pose));
    }
    recording_ = *recording;
    const auto sequence = open();
    ASSERT_TRUE(sequence.ok()) << sequence.error().message;
    EXPECT_TRUE((*sequence)->has_poses());
    EXPECT_LT(((*sequence)->read_pose(2)->translation - Eigen::Vector3d(1, 0, 1)).norm(), 1e-6);
  }
}

// Wheels and a filter, or two sources of odometry, disagree about where a robot is.
TEST_F(RecordingOptions, OdometryIsNotMixedWithOtherMotionsOfItsFrame) {
  for (const bool has_transforms : {true, false}) {
    recording_ = TestRecording();
    add_views(recording_, {});
    add_info(recording_, "/rgb/camera_info");
    for (int i = 0; i < 20; ++i) {
      const double time_s = 9.48 + 0.05 * i;
      const Rigid3 pose = Rigid3::from_translation({time_s, 0, 0});
      if (has_transforms)
        recording_.add("/tf", "tf2_msgs/TFMessage", time_s,
                       recordings::transform_message(time_s, "odom", "camera", pose));
      else
        recording_.add("/filtered", "nav_msgs/Odometry", time_s,
                       recordings::odometry_message(time_s, "odom", "camera", pose));
      recording_.add(
          "/wheels", "nav_msgs/Odometry", time_s + 0.02,
          recordings::odometry_message(time_s + 0.02, "odom", "camera", Rigid3::from_translation({0, 5, 0})));
    }
    const auto sequence = open();
    ASSERT_TRUE(sequence.ok()) << sequence.error().message;
    EXPECT_LT(((*sequence)->read_pose(1)->translation - Eigen::Vector3d(10.1, 0, 0)).norm(), 1e-6) << has_transforms;
  }
}

// Poses of something else, such as a target, do not move a camera that is fixed to the world.
TEST_F(RecordingOptions, PosesDoNotMoveAFixedCamera) {
  for (const char* frame : {"base", "world"}) {
    recording_ = TestRecording();
    add_views(recording_, {});
    add_info(recording_, "/rgb/camera_info");
    recording_.add("/tf_static", "tf2_msgs/TFMessage", 9,
                   recordings::transform_message(9, "world", "camera", Rigid3::from_translation({0.5, 0, 1})));
    for (int i = 0; i < 4; ++i) {
      const double time_s = 10 + 0.1 * i;
      recording_.add("/target", "geometry_msgs/PoseStamped", time_s,
                     recordings::pose_message(time_s, frame, Rigid3::from_translation({0.5 * i, 0, 0})));
    }
    const auto sequence = open();
    ASSERT_TRUE(sequence.ok()) << sequence.error().message;
    EXPECT_LT(((*sequence)->read_pose(2)->translation - Eigen::Vector3d(0.5, 0, 1)).norm(), 1e-6) << frame;
    EXPECT_THAT((*sequence)->notes(), Contains("poses: camera in world")) << frame;
  }
}

TEST_F(RecordingOptions, FramesThatNothingConnects) {
  add_views(recording_, {});
  add_info(recording_, "/rgb/camera_info");
  const auto notes = [&] {
    const auto sequence = open();
    return sequence.ok() ? (*sequence)->notes() : std::vector<std::string>{sequence.error().message};
  };
  EXPECT_THAT(notes(), Contains("no camera poses: no transform of the frame 'camera' changes"));
  for (int i = 0; i < 4; ++i)
    recording_.add(
        "/tf", "tf2_msgs/TFMessage", 10 + 0.1 * i,
        recordings::transform_message(10 + 0.1 * i, "odom", "base", Rigid3::from_translation({0.5 * i, 0, 0})));
  EXPECT_THAT(notes(), Contains(HasSubstr("nothing fixes it to a frame that moves (base): was /tf_static recorded?")));
}

TEST_F(RecordingOptions, UnusedTopicsMayBeUnreadable) {
  add_views(recording_, {});
  add_info(recording_, "/rgb/camera_info");
  recording_.add_cut("/debug/image_raw", "sensor_msgs/Image", 9);
  const auto sequence = open();
  ASSERT_TRUE(sequence.ok()) << sequence.error().message;
  EXPECT_EQ((*sequence)->num_views(), 3);
  EXPECT_THAT((*sequence)->notes(), Contains(HasSubstr("damaged, what can be read is used: ")));
  TestRecording damaged;
  damaged.add_cut("/rgb/image_raw", "sensor_msgs/Image", 9);
  add_views(damaged, {});
  recording_ = damaged;
  EXPECT_THAT(error(), testing::AllOf(HasSubstr("has no topic of colour images"), HasSubstr("record is damaged")));
}

TEST_F(RecordingOptions, UnusedStreamsOfLibrealsenseMayBeUnreadable) {
  const TopicsOfTest topics{.color = "/device_0/sensor_1/Color_0/image/data",
                            .depth = "/device_0/sensor_0/Depth_0/image/data"};
  add_views(recording_, topics);
  add_info(recording_, "/device_0/sensor_1/Color_0/info/camera_info");
  recording_.add_cut("/device_0/sensor_0/Infrared_1/tf/0", "geometry_msgs/Transform", 9);
  const auto sequence = open();
  ASSERT_TRUE(sequence.ok()) << sequence.error().message;
  EXPECT_EQ((*sequence)->num_views(), 3);
  recording_.add_cut("/device_0/sensor_0/Depth_0/tf/0", "geometry_msgs/Transform", 9);
  EXPECT_THAT(error(), HasSubstr("record is damaged"));
}

TEST_F(RecordingOptions, SeveralTopicsMustBeChosen) {
  add_views(recording_,
            {.color = "/a/rgb/image_raw", .depth = "/a/depth/image_raw", .color_frame = "a", .depth_frame = "a"});
  add_views(recording_,
            {.color = "/b/rgb/image_raw", .depth = "/b/depth/image_raw", .color_frame = "b", .depth_frame = "b"});
  add_info(recording_, "/a/rgb/camera_info");
  add_info(recording_, "/b/rgb/camera_info");
  EXPECT_THAT(error(), HasSubstr("several topics of colour images (/a/rgb/image_raw, /b/rgb/image_raw): choose one by "
                                 "--color-topic"));
  OpenSequenceOptions options;
  options.topics.color = "/b/rgb/image_raw";
  EXPECT_THAT(error(options), HasSubstr("--depth-topic"));
  options.topics.depth = "/b/depth/image_raw";
  EXPECT_TRUE(open(options).ok());
}

TEST_F(RecordingOptions, DepthOfAnotherCameraNeedsItsPlace) {
  add_views(recording_,
            {.color = "/rgb/image_raw", .depth = "/depth/image_raw", .color_frame = "camera", .depth_frame = "ir"});
  add_info(recording_, "/rgb/camera_info");
  EXPECT_THAT(error(), HasSubstr("has no CameraInfo: record registered depth"));
  add_info(recording_, "/depth/camera_info");
  EXPECT_THAT(error(), HasSubstr("nothing says where the depth camera (ir) is"));
  recording_.add("/tf_static", "tf2_msgs/TFMessage", 9,
                 recordings::transform_message(9, "camera", "ir", Rigid3::from_translation({0.1, 0, 0})));
  const auto sequence = open();
  ASSERT_TRUE(sequence.ok()) << sequence.error().message;
  const auto frame = (*sequence)->read_view(0);
  ASSERT_TRUE(frame.ok()) << frame.error().message;
  // 30 px * 0.1 m / 1 m: the depth lies 3 px to the right.
  EXPECT_TRUE(std::isnan(frame->depth_m(2, 5)));
  EXPECT_NEAR(frame->depth_m(3, 5), 1, 1e-6);
}

// Registered depth has the CameraInfo of the colours. More exact intrinsics do not make it another camera.
TEST_F(RecordingOptions, GivenIntrinsicsDoNotRegisterDepthAnew) {
  add_views(recording_, {});
  add_info(recording_, "/depth/camera_info");
  OpenSequenceOptions options;
  options.intrinsics = "30,30,9.5,4.5";
  const auto plain = open(options);
  ASSERT_TRUE(plain.ok()) << plain.error().message;
  EXPECT_THAT((*plain)->notes(), Not(Contains(HasSubstr("registered here"))));
  add_info(recording_, "/rgb/camera_info");
  options.intrinsics = "31,31,9.5,4.5";
  const auto refined = open(options);
  ASSERT_TRUE(refined.ok()) << refined.error().message;
  EXPECT_THAT((*refined)->notes(), Not(Contains(HasSubstr("registered here"))));
  EXPECT_EQ((*refined)->read_view(0)->camera.fx, 31);
}

// A name says that depth is registered, but not whether it is rectified. Depth grows by 1 cm per column. The lens moves
// what pixel (1, 5) sees to column 0; a camera of half the focal length sees it in column 5.
TEST_F(RecordingOptions, RegisteredDepthHasItsOwnLensAndIntrinsics) {
  struct Case {
    std::string color;
    std::string depth;
    double k1;
    double rectified_fx;
    double depth_m;
  };
  for (const Case& c : {Case{"/rgb/image_color", "/depth_registered/image_rect", 2, 30, 1.01},
                        {"/rgb/image_rect_color", "/depth_registered/image_raw", 2, 30, 1.0},
                        {"/rgb/image_color", "/depth_registered/image_raw", 2, 30, 1.0},
                        {"/rgb/image_color", "/depth_registered/image_rect", 0, 15, 1.05}}) {
    recording_ = TestRecording();
    recording_.add(c.color, "sensor_msgs/Image", 10,
                   recordings::image_message(10, "camera", "bgr8", kImageWidth, kImageHeight,
                                             std::string(3 * kImageWidth * kImageHeight, '\x50')));
    std::string depth;
    for (int i = 0; i < kImageWidth * kImageHeight; ++i)
      depth += recordings::packed(static_cast<std::uint16_t>(1000 + 10 * (i % kImageWidth)));
    recording_.add(c.depth, "sensor_msgs/Image", 10,
                   recordings::image_message(10, "camera", "16UC1", kImageWidth, kImageHeight, depth));
    for (const char* info : {"/rgb/camera_info", "/depth_registered/camera_info"})
      recording_.add(info, "sensor_msgs/CameraInfo", 9,
                     recordings::camera_info_message(
                         "camera", kImageWidth, kImageHeight, "plumb_bob", {c.k1, 0, 0, 0, 0}, kIntrinsics,
                         {c.rectified_fx, 0, 9.5, 0, 0, c.rectified_fx, 4.5, 0, 0, 0, 1, 0}));
    const auto sequence = open();
    ASSERT_TRUE(sequence.ok()) << sequence.error().message;
    EXPECT_NEAR((*sequence)->read_view(0)->depth_m(1, 5), c.depth_m, 1e-6) << c.color << " " << c.depth;
  }
}

TEST_F(RecordingOptions, LensesOfCameraInfo) {
  add_views(recording_, {});
  add_info(recording_, "/rgb/camera_info", {0.5, 0, 0, 0}, "equidistant");
  const auto sequence = open();
  ASSERT_TRUE(sequence.ok()) << sequence.error().message;
  EXPECT_NEAR((*sequence)->read_view(0)->depth_m(10, 5), 1, 1e-6);
  TestRecording other;
  add_views(other, {});
  add_info(other, "/rgb/camera_info", {0.5}, "fov");
  recording_ = other;
  EXPECT_THAT(error(), HasSubstr("'fov' is not supported"));
}

TEST_F(RecordingOptions, UnitsThatCannotBe) {
  add_views(recording_, {});
  add_info(recording_, "/rgb/camera_info");
  OpenSequenceOptions options;
  options.depth_scale_m = 1;
  EXPECT_THAT(error(options), HasSubstr("the unit is wrong"));
  options.depth_scale_m = 0.0005;
  EXPECT_NEAR((*open(options))->read_view(0)->depth_m(1, 1), 0.5, 1e-6);
}

TEST_F(RecordingOptions, PartsOfABag) {
  add_views(recording_, {});
  add_info(recording_, "/rgb/camera_info");
  const std::string first = recording_.bytes();
  TestRecording second;
  const std::string color(3 * kImageWidth * kImageHeight, '\x50');
  std::string depth;
  for (int i = 0; i < kImageWidth * kImageHeight; ++i) depth += recordings::packed(std::uint16_t{1500});
  second.add("/depth/image_raw", "sensor_msgs/Image", 11,
             recordings::image_message(11, "camera", "16UC1", kImageWidth, kImageHeight, depth));
  second.add("/rgb/image_raw", "sensor_msgs/Image", 11,
             recordings::image_message(11, "camera", "bgr8", kImageWidth, kImageHeight, color));
  io::write_text(directory_ / "bag/metadata.yaml", "rosbag2_bagfile_information:\n");
  io::write_text(directory_ / "bag/bag_0.mcap", first);
  io::write_text(directory_ / "bag/bag_1.mcap", second.bytes());
  const auto sequence = open_sequence(directory_ / "bag");
  ASSERT_TRUE(sequence.ok()) << sequence.error().message;
  ASSERT_EQ((*sequence)->num_views(), 4);
  EXPECT_NEAR((*sequence)->read_view(3)->depth_m(1, 1), 1.5, 1e-6);
  io::write_text(directory_ / "packed/metadata.yaml", "x\n");
  io::write_text(directory_ / "packed/bag_0.db3.zstd", "x");
  EXPECT_THAT(open_sequence(directory_ / "packed").error().message, HasSubstr("zstd -d"));
}

TEST_F(RecordingOptions, ImagesBehindTooManyTransformsAreFound) {
  for (int i = 0; i < 5; ++i)
    recording_.add("/tf", "tf2_msgs/TFMessage", 9 + 0.1 * i,
                   recordings::transform_message(9 + 0.1 * i, "world", "camera", Rigid3()));
  add_views(recording_, {});
  io::write_text(directory_ / "r.mcap", recording_.bytes());
  const auto recording = open_recording(directory_ / "r.mcap");
  ASSERT_TRUE(recording.ok()) << recording.error().message;
  const auto topics = io::find_view_topics(**recording, {});
  ASSERT_TRUE(topics.ok()) << topics.error().message;
  const io::RecordingScan scan = io::scan_recording(**recording, *topics, 3);
  EXPECT_EQ(scan.colors.size(), 3U);
  EXPECT_EQ(scan.depths.size(), 3U);
  EXPECT_THAT(scan.damage, HasSubstr("more than 3 transforms"));
}

}  // namespace
}  // namespace resight
