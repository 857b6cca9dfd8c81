// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>

#include "resight/io/internal/adjusted_sequence.hpp"
#include "resight/io/internal/depth_check.hpp"
#include "resight/io/internal/files.hpp"
#include "resight/io/internal/listed_sequence.hpp"
#include "resight/io/internal/recording_images.hpp"
#include "resight/io/internal/recording_poses.hpp"
#include "resight/io/internal/recording_topics.hpp"
#include "resight/io/internal/sequences.hpp"
#include "resight/recordings/recording.hpp"
#include "resight/sensor/rectify.hpp"

/// Recordings of ROS, MCAP and librealsense as sequences of views.
namespace resight::io {
namespace {

/// A camera of the recording: pinhole camera and lens for an image of its size.
struct RecordedCamera {
  Camera camera;
  LensDistortion lens;
};

/// Images of a rectified topic have no distortion, and the intrinsics of the projection matrix P.
Result<RecordedCamera> to_camera(const CameraInfoMessage& info, std::string_view image_topic) {
  const bool is_rectified = image_topic.find("rect") != image_topic.npos && info.p[0] > 0;
  constexpr std::uint32_t kMaxSide = 16384;
  if (info.width > kMaxSide || info.height > kMaxSide)
    return Error{fmt::format("{}: CameraInfo is for images of {}x{} px", image_topic, info.width, info.height)};
  const auto& k = info.k;
  RecordedCamera recorded;
  recorded.camera = {static_cast<int>(info.width), static_cast<int>(info.height), k[0], k[4], k[2], k[5]};
  if (is_rectified)
    recorded.camera = {recorded.camera.width, recorded.camera.height, info.p[0], info.p[5], info.p[2], info.p[6]};
  if (!recorded.camera.is_valid())
    return Error{
        fmt::format("{}: CameraInfo holds no valid intrinsics (not calibrated?): give --intrinsics "
                    "fx,fy,cx,cy or FILE",
                    image_topic)};
  if (is_rectified) return recorded;
  const auto lens = LensDistortion::make(info.distortion_model, info.distortion);
  if (!lens) return Error{fmt::format("{}: {}", image_topic, lens.error().message)};
  recorded.lens = *lens;
  return recorded;
}

/// Whether two cameras at one place see the same in each pixel.
bool sees_the_same(const RecordedCamera& a, const RecordedCamera& b) {
  constexpr double kMaxOffset_px = 1;
  if (a.lens != b.lens || (b.camera.width != 0 && a.camera.width != b.camera.width)) return false;  // 0: not known
  for (const Eigen::Vector2d& corner : {Eigen::Vector2d(0, 0), Eigen::Vector2d(a.camera.width, a.camera.height)}) {
    const Eigen::Vector2d there = b.camera.project(a.camera.unproject(corner.x(), corner.y(), 1));
    if ((there - corner).cwiseAbs().maxCoeff() > kMaxOffset_px) return false;
  }
  return true;
}

/// How depth comes into the image of the colour camera.
struct Registration {
  bool is_needed = false;
  RecordedCamera depth_camera;
  Rigid3 color_from_depth;
};

struct RecordedView {
  MessageEntry color;
  MessageEntry depth;
  std::string name;
  Rigid3 world_from_camera;
};

class RecordingSequence final : public Sequence {
 public:
  RecordingSequence(fs::path file, std::unique_ptr<Recording> recording)
      : file_(std::move(file)), recording_(std::move(recording)) {}

  [[nodiscard]] std::string format() const override { return recording_->format(); }
  [[nodiscard]] int num_views() const override { return static_cast<int>(views_.size()); }
  [[nodiscard]] std::string view_name(int view) const override { return views_.at(view).name; }
  [[nodiscard]] bool has_poses() const override { return has_poses_; }
  [[nodiscard]] std::vector<std::string> notes() const override { return notes_; }
  [[nodiscard]] Result<Rigid3> read_pose(int view) const override { return views_.at(view).world_from_camera; }
  [[nodiscard]] Result<RgbdFrame> read_view(int view) const override;

  [[nodiscard]] Result<void> prepare(const OpenSequenceOptions& options);
  [[nodiscard]] const Recording& recording() const { return *recording_; }

 private:
  [[nodiscard]] const RecordedTopic& topic(int index) const {
    return recording_->topics()[static_cast<std::size_t>(index)];
  }
  [[nodiscard]] Result<void> find_cameras(const OpenSequenceOptions& options);
  [[nodiscard]] std::optional<RecordedCamera> recorded_color_camera() const;
  [[nodiscard]] Result<void> find_registration(const RecordedPoses& poses);
  [[nodiscard]] Result<void> find_views(const std::vector<RecordedPair>& pairs, const RecordedPoses& poses,
                                        const OpenSequenceOptions& options);
  [[nodiscard]] Result<Image<float>> read_registered_depth(const RecordedView& view, const Camera& color) const;
  void describe(const RecordedPoses& poses, const OpenSequenceOptions& options);
  void note_undecodable(std::size_t num_bad, std::size_t num_all, std::string_view what);

  fs::path file_;
  std::unique_ptr<Recording> recording_;
  ViewTopics topics_;
  RecordedCamera color_camera_;
  Registration registration_;
  std::optional<double> depth_unit_m_;
  std::vector<RecordedView> views_;
  std::vector<std::string> notes_;
  bool has_poses_ = false;
};

Result<void> RecordingSequence::find_cameras(const OpenSequenceOptions& options) {
  if (!options.intrinsics.empty()) {
    const auto given = parse_calibration(options.intrinsics);
    if (!given) return given.error();
    const Intrinsics& k = given->intrinsics;
    color_camera_ = {{given->width, given->height, k.fx, k.fy, k.cx, k.cy}, given->lens};
  } else if (topics_.color_info) {
    const auto camera = to_camera(*topics_.color_info, topic(topics_.color).name);
    if (!camera) return camera.error();
    color_camera_ = *camera;
  } else {
    return Error{
        fmt::format("has no sensor_msgs/CameraInfo for {}: choose it by --camera-info, or give --intrinsics "
                    "fx,fy,cx,cy or FILE",
                    topic(topics_.color).name)};
  }
  // Depth without CameraInfo is that of the colour camera, if of any. It may be rectified where the colours are not.
  const auto& depth_info = topics_.depth_info ? topics_.depth_info : topics_.color_info;
  if (!depth_info) return {};
  const auto camera = to_camera(*depth_info, topic(topics_.depth).name);
  if (camera) registration_.depth_camera = *camera;
  return {};
}

/// The colour camera as the recording describes it. What the user says of it may be more exact.
std::optional<RecordedCamera> RecordingSequence::recorded_color_camera() const {
  if (!topics_.color_info) return std::nullopt;
  const auto recorded = to_camera(*topics_.color_info, topic(topics_.color).name);
  return recorded.ok() ? std::optional(*recorded) : std::nullopt;
}

Result<void> RecordingSequence::find_registration(const RecordedPoses& poses) {
  const std::string& name = topic(topics_.depth).name;
  const RecordedCamera& depth = registration_.depth_camera;
  const bool says_registered = name.find("aligned") != name.npos || name.find("registered") != name.npos;
  const auto between = poses.color_from_depth(topics_);
  const bool same_frame = topics_.color_frame == topics_.depth_frame && !between;
  const auto recorded = recorded_color_camera();
  const bool same_camera = !depth.camera.is_valid() || sees_the_same(depth, recorded.value_or(color_camera_));
  const bool same_place = same_frame || says_registered;
  if (same_place && same_camera) return {};
  // A name does not say whether the images are rectified; CameraInfo of both does. Intrinsics that the user gives may
  // differ because they are more exact.
  if (says_registered && !recorded) return {};
  if (!same_place && !(topics_.depth_info && depth.camera.is_valid()))
    return Error{
        fmt::format("{} is not registered to the colour, and has no CameraInfo: record registered depth", name)};
  if (!same_place && !between)
    return Error{
        fmt::format("nothing says where the depth camera ({}) is relative to the colour camera ({}): record "
                    "/tf_static, or registered depth",
                    topics_.depth_frame, topics_.color_frame)};
  registration_.is_needed = true;
  registration_.color_from_depth = between.value_or(Rigid3());
  return {};
}

Result<void> RecordingSequence::find_views(const std::vector<RecordedPair>& pairs, const RecordedPoses& poses,
                                           const OpenSequenceOptions& options) {
  SequenceTable table;
  table.is_recording = true;
  const bool uses_transforms = options.poses.empty() && poses.has_poses();
  std::size_t num_without_pose = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto pose = uses_transforms ? poses.world_from_camera(pairs[i].depth_time_ns) : Rigid3();
    if (!pose) {
      ++num_without_pose;
      continue;
    }
    ListedView view;
    view.name = fmt::format("{:06d}", i);
    view.image_id = static_cast<int>(i);
    view.time_s = static_cast<double>(pairs[i].depth_time_ns) * 1e-9;
    view.world_from_camera = *pose;
    table.views.push_back(std::move(view));
  }
  if (table.views.empty())
    return Error{pairs.empty() ? "no colour and depth image lie near in time (--max-time-difference-ms)"
                               : "no view has a pose near in time; --poses auto or fixed does without"};
  if (num_without_pose > 0)
    table.notes.push_back(
        fmt::format("{} of {} views have no pose near in time and are left out", num_without_pose, pairs.size()));
  table.has_poses = uses_transforms || table.views.size() == 1;
  if (const auto done = apply_options(table, options); !done) return done;
  has_poses_ = table.has_poses;
  for (const ListedView& view : table.views) {
    const RecordedPair& pair = pairs[static_cast<std::size_t>(view.image_id)];
    views_.push_back({pair.color, pair.depth, view.name, view.world_from_camera});
  }
  notes_.insert(notes_.end(), table.notes.begin(), table.notes.end());
  return {};
}

void RecordingSequence::describe(const RecordedPoses& poses, const OpenSequenceOptions& options) {
  const bool is_float = topics_.depth_encoding.starts_with("32FC1");
  const std::string unit = depth_unit_m_ ? fmt::format("{:.6g} m per unit", *depth_unit_m_)
                           : is_float    ? std::string("metres")
                                         : std::string("taken as millimetres (--depth-scale)");
  notes_.push_back(fmt::format("colour {}, depth {}, {}{}", topic(topics_.color).name, topic(topics_.depth).name, unit,
                               registration_.is_needed ? ", registered here" : ""));
  if (options.poses.empty()) notes_.push_back(poses.describe());
}

void RecordingSequence::note_undecodable(std::size_t num_bad, std::size_t num_all, std::string_view what) {
  if (num_bad > 0)
    notes_.push_back(fmt::format("{} of {} {} cannot be decoded and are left out", num_bad, num_all, what));
}

Result<void> RecordingSequence::prepare(const OpenSequenceOptions& options) {
  auto topics = find_view_topics(*recording_, options.topics);
  if (!topics) {
    if (recording_->damage().empty()) return topics.error();
    return Error{fmt::format("{}; damaged: {}", topics.error().message, recording_->damage())};
  }
  topics_ = std::move(*topics);
  const RecordingScan scan = scan_recording(*recording_, topics_);
  const auto poses = RecordedPoses::make(*recording_, scan, topics_, options.topics);
  if (!poses) return poses.error();
  if (const auto done = find_cameras(options); !done) return done;
  if (const auto done = find_registration(*poses); !done) return done;
  depth_unit_m_ = options.depth_scale_m ? options.depth_scale_m : poses->depth_unit_m();
  describe(*poses, options);
  for (const std::string& damage : {recording_->damage(), scan.damage, topics_.damage}) {
    if (damage.empty()) continue;
    notes_.push_back("damaged, what can be read is used: " + damage);
    break;
  }
  note_undecodable(scan.num_bad_images, scan.num_images, "images");
  note_undecodable(scan.num_bad_transforms, scan.num_transform_messages, "messages with transforms");
  const RecordedPairs images = pair_images(scan, options.topics.max_time_difference_s);
  if (images.by_recording_times)
    notes_.emplace_back(
        "the times in the headers do not fit together, or repeat: images are paired by the times of recording");
  if (const auto done = find_views(images.pairs, *poses, options); !done) return done;
  const auto first = read_view(0);
  if (!first) return Error{first.error().message};
  return check_depth_unit(*first);
}

Result<Image<float>> RecordingSequence::read_registered_depth(const RecordedView& view, const Camera& color) const {
  const auto bytes = recording_->read(view.depth, kMaxMessageBytes);
  if (!bytes) return bytes.error();
  auto depth = decode_depth_message(*bytes, topic(topics_.depth), depth_unit_m_);
  if (!depth) return depth;
  if (!registration_.is_needed) {
    if (depth->width() != color.width || depth->height() != color.height)
      return Error{fmt::format("{} has images of {}x{}, but the colour {}x{}: record registered depth",
                               topic(topics_.depth).name, depth->width(), depth->height(), color.width, color.height)};
    return undistort_depth(*depth, color, color_camera_.lens);
  }
  Camera camera = registration_.depth_camera.camera;
  if (camera.width != depth->width() || camera.height != depth->height())
    return Error{fmt::format("{} has images of {}x{}, but its CameraInfo is for {}x{}", topic(topics_.depth).name,
                             depth->width(), depth->height(), camera.width, camera.height)};
  return register_depth(undistort_depth(*depth, camera, registration_.depth_camera.lens), camera,
                        registration_.color_from_depth, color);
}

Result<RgbdFrame> RecordingSequence::read_view(int number) const {
  const RecordedView& view = views_.at(static_cast<std::size_t>(number));
  const auto bytes = recording_->read(view.color, kMaxMessageBytes);
  if (!bytes) return bytes.error();
  auto color = decode_color_message(*bytes, topic(topics_.color));
  if (!color) return file_error(file_, color.error().message);
  const Camera& k = color_camera_.camera;
  Calibration calibration;
  calibration.intrinsics = {k.fx, k.fy, k.cx, k.cy};
  calibration.width = k.width;
  calibration.height = k.height;
  const auto fits = check_calibration(calibration, color->width(), color->height(), topic(topics_.color).name);
  if (!fits) return file_error(file_, fits.error().message);
  RgbdFrame frame;
  frame.name = view.name;
  frame.camera = {color->width(), color->height(), k.fx, k.fy, k.cx, k.cy};
  auto depth = read_registered_depth(view, frame.camera);
  if (!depth) return file_error(file_, depth.error().message);
  frame.depth_m = std::move(*depth);
  frame.color = undistort_color(*color, frame.camera, color_camera_.lens);
  frame.world_from_camera = view.world_from_camera;
  if (const auto done = check_frame(frame); !done) return file_error(file_, done.error().message);
  return frame;
}

}  // namespace

namespace {

/// By the names of the topics, and by what RealSense's recordings say of the device ("Name": "Intel RealSense D435").
const DepthSensor* detect_sensor(const Recording& recording) {
  constexpr std::size_t kMaxInfoBytes = 512;
  const FirstMessages first(recording);
  std::string text;
  for (std::size_t t = 0; t < recording.topics().size(); ++t) {
    if (recording.topics()[t].type != "diagnostic_msgs/KeyValue") continue;
    const auto info = first.read(static_cast<int>(t), kMaxInfoBytes);
    if (info.ok() && *info) text += **info + "\n";
  }
  for (const RecordedTopic& topic : recording.topics()) text += topic.name + "\n";
  return detect_depth_sensor(text);
}

}  // namespace

SequenceResult open_recording_sequence(const fs::path& where, const OpenSequenceOptions& options) {
  auto recording = open_recording(where);
  if (!recording) return recording.error();
  auto sequence = std::make_unique<RecordingSequence>(where, std::move(*recording));
  if (const auto done = sequence->prepare(options); !done) {
    const std::string& message = done.error().message;
    return message.starts_with(where.string()) ? done.error() : file_error(where, message);
  }
  const DepthSensor* sensor = options.sensor == nullptr ? detect_sensor(sequence->recording()) : nullptr;
  if (sensor == nullptr || sensor == &depth_sensors().front()) return SequenceResult(std::move(sequence));
  return with_sensor(std::move(sequence), *sensor, "by the names in the recording; --sensor changes it");
}

}  // namespace resight::io
