// SPDX-License-Identifier: Apache-2.0
#include "resight/io/internal/recording_poses.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "resight/core/printable.hpp"

namespace resight::io {
namespace {

constexpr double kMaxTransformGap_s = 0.5;  ///< Between the transforms before and after an image.

bool is_world_name(std::string_view frame) {
  return frame == "world" || frame == "map" || frame == "odom" || frame == "earth" || frame == "vicon";
}

/// For messages: as many names as fit into a line.
std::string list_frames(const std::vector<std::string>& frames) {
  std::string names;
  for (const std::string& frame : frames)
    if (names.size() < 300) names += (names.empty() ? "" : ", ") + printable(frame);
  return names.empty() ? "none" : names;
}

}  // namespace

Result<RecordedPoses> RecordedPoses::make(const Recording& recording, const RecordingScan& scan,
                                          const ViewTopics& topics, const RecordingTopics& given) {
  RecordedPoses poses;
  std::vector<ScannedTransform> odometry;
  std::vector<StampedTransform> stamped_poses;
  for (const ScannedTransform& scanned : scan.transforms) {
    const RecordedTopic& topic = recording.topics()[static_cast<std::size_t>(scanned.topic)];
    if (topic.type == "geometry_msgs/PoseStamped") {
      // Of several topics of poses, the first is taken.
      if (poses.pose_topic_.empty()) poses.pose_topic_ = topic.name;
      if (poses.pose_topic_ == topic.name) stamped_poses.push_back(scanned.transform);
    } else if (topic.type == "nav_msgs/Odometry") {
      odometry.push_back(scanned);
    } else {
      poses.transforms_.add(scanned.transform, topic.name.ends_with("tf_static"));
    }
  }
  poses.add_odometry(odometry);
  poses.camera_frame_ = given.camera_frame.empty() ? topics.color_frame : given.camera_frame;
  poses.posed_frame_ = poses.transforms_.root_of(poses.camera_frame_);
  const bool is_fixed = poses.transforms_.knows(poses.camera_frame_) && is_world_name(poses.posed_frame_);
  if (stamped_poses.empty() || is_fixed || poses.transforms_.is_moving(poses.camera_frame_)) poses.pose_topic_.clear();
  if (!poses.pose_topic_.empty())
    for (StampedTransform& transform : stamped_poses) {
      if (transform.parent.empty()) transform.parent = "world";
      transform.child = poses.posed_frame_;
      poses.transforms_.add(transform, false);
    }
  poses.transforms_.finish();
  if (const auto done = poses.choose_frames(given); !done) return done.error();
  if (const auto done = poses.read_librealsense(recording, topics); !done) return done.error();
  return poses;
}

/// Odometry also tells where a frame is, if no transform does. Wheels and a filter disagree, so that of several topics
/// the first is taken.
void RecordedPoses::add_odometry(const std::vector<ScannedTransform>& odometry) {
  constexpr int kTransforms = -1;
  std::map<std::string, int> sources;  // By the frame that they move.
  for (const ScannedTransform& scanned : odometry) {
    const std::string& frame = scanned.transform.child;
    const auto [source, is_new] = sources.try_emplace(frame, scanned.topic);
    if (is_new && transforms_.root_of(frame) != frame) source->second = kTransforms;
    if (source->second == scanned.topic) transforms_.add(scanned.transform, false);
  }
}

Result<void> RecordedPoses::choose_frames(const RecordingTopics& given) {
  const std::string root = transforms_.root_of(camera_frame_);
  if (given.world_frame.empty()) {
    if (transforms_.knows(camera_frame_) && (transforms_.is_moving(camera_frame_) || is_world_name(root)))
      world_frame_ = root;
    if (!given.camera_frame.empty() && !transforms_.knows(camera_frame_))
      return Error{fmt::format("has no transform of the frame '{}' (--camera-frame)", printable(camera_frame_))};
    return {};
  }
  if (!transforms_.knows(given.world_frame) || !transforms_.knows(camera_frame_) ||
      transforms_.root_of(given.world_frame) != root) {
    return Error{fmt::format("no transforms connect the frames '{}' and '{}'; frames: {}", given.world_frame,
                             printable(camera_frame_), list_frames(transforms_.frames()))};
  }
  world_frame_ = given.world_frame;
  return {};
}

/// librealsense writes for each stream its transform from a common reference, and the unit of depth as an option.
Result<void> RecordedPoses::read_librealsense(const Recording& recording, const ViewTopics& topics) {
  const auto stream_of = [&](int topic) {
    const std::string& name = recording.topics()[static_cast<std::size_t>(topic)].name;
    const std::size_t end = name.find("/image/data");
    return name.starts_with("/device_") && end != name.npos ? name.substr(0, end) : std::string();
  };
  const std::string color = stream_of(topics.color);
  const std::string depth = stream_of(topics.depth);
  if (color.empty() || depth.empty()) return {};
  std::optional<Rigid3> color_from_reference;
  std::optional<Rigid3> depth_from_reference;
  const FirstMessages first(recording);
  for (std::size_t t = 0; t < recording.topics().size(); ++t) {
    const RecordedTopic& topic = recording.topics()[t];
    const bool is_unit =
        topic.name.ends_with("/option/Depth_Units/value") || topic.name.ends_with("/option/Depth Units/value");
    const bool is_of_color = topic.name.starts_with(color + "/tf/");
    const bool is_of_depth = topic.name.starts_with(depth + "/tf/");
    const bool is_transform = topic.type == "geometry_msgs/Transform" && (is_of_color || is_of_depth);
    if (!is_transform && !(is_unit && topic.type == "std_msgs/Float32")) continue;
    const auto bytes = first.read(static_cast<int>(t), 4096);
    if (!bytes) return bytes.error();
    if (!*bytes) continue;
    if (is_unit) {
      const auto unit_m = decode_float(**bytes, topic.layout, topic.name);
      if (unit_m && *unit_m > 1e-7 && *unit_m <= 1) depth_unit_m_ = *unit_m;
      continue;
    }
    const auto transform = decode_plain_transform(**bytes, topic.layout, topic.name);
    if (!transform) return transform.error();
    if (is_of_color) color_from_reference = *transform;
    if (is_of_depth) depth_from_reference = *transform;
  }
  if (color_from_reference && depth_from_reference)
    color_from_depth_ = *color_from_reference * depth_from_reference->inverse();
  return {};
}

std::optional<Rigid3> RecordedPoses::world_from_camera(std::int64_t stamp_ns) const {
  return transforms_.find(world_frame_, camera_frame_, stamp_ns, kMaxTransformGap_s);
}

std::optional<Rigid3> RecordedPoses::color_from_depth(const ViewTopics& topics) const {
  if (color_from_depth_) return color_from_depth_;
  if (topics.color_frame == topics.depth_frame) return std::nullopt;
  // The two are fixed to each other, so that any time will do.
  return transforms_.find(topics.color_frame, topics.depth_frame, 0, 1e300);
}

std::string RecordedPoses::describe() const {
  if (!has_poses()) {
    const std::vector<std::string> moving = transforms_.moving_frames();
    const std::string why =
        fmt::format("no camera poses: no transform of the frame '{}' changes", printable(camera_frame_));
    if (moving.empty()) return why;
    return fmt::format("{}, and nothing fixes it to a frame that moves ({}): was /tf_static recorded? (--camera-frame)",
                       why, list_frames(moving));
  }
  if (!pose_topic_.empty())
    return fmt::format("poses: {}, taken as those of {}", printable(pose_topic_), printable(posed_frame_));
  return fmt::format("poses: {} in {}", printable(camera_frame_), printable(world_frame_));
}

}  // namespace resight::io
