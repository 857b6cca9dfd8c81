// SPDX-License-Identifier: Apache-2.0
#include "resight/recordings/message.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "resight/recordings/internal/message_reader.hpp"

namespace resight {
namespace {

using recordings::MessageReader;

Error cut_message(std::string_view what) { return Error{fmt::format("{}: a message is damaged or cut off", what)}; }

std::int64_t read_stamp(MessageReader& reader) {
  const std::int64_t seconds =
      reader.is_cdr() ? reader.value<std::int32_t>() : static_cast<std::int64_t>(reader.value<std::uint32_t>());
  return seconds * 1000000000 + reader.value<std::uint32_t>();
}

/// tf2 has no leading slash; old drivers write one.
std::string without_slash(std::string frame) {
  if (frame.starts_with('/')) frame.erase(0, 1);
  return frame;
}

MessageHeader read_header(MessageReader& reader) {
  MessageHeader header;
  if (!reader.is_cdr()) reader.value<std::uint32_t>();  // sequence number
  header.stamp_ns = read_stamp(reader);
  header.frame = without_slash(reader.text());
  return header;
}

Eigen::Vector3d read_vector(MessageReader& reader) {
  const auto x = reader.value<double>();
  const auto y = reader.value<double>();
  const auto z = reader.value<double>();
  return {x, y, z};
}

/// Position and orientation. None if it is no rigid motion.
std::optional<Rigid3> read_rigid(MessageReader& reader) {
  const Eigen::Vector3d translation = read_vector(reader);
  const Eigen::Vector3d xyz = read_vector(reader);
  const auto w = reader.value<double>();
  const Eigen::Quaterniond rotation(w, xyz.x(), xyz.y(), xyz.z());
  constexpr double kMaxTranslation_m = 1e4;
  const bool is_near = translation.cwiseAbs().maxCoeff() <= kMaxTranslation_m;  // false for NaN
  if (!is_near || !translation.allFinite() || !(std::abs(rotation.norm() - 1) <= 1e-2)) return std::nullopt;
  return Rigid3{rotation.normalized().toRotationMatrix(), translation};
}

ImageMessage read_image(MessageReader& reader) {
  ImageMessage image;
  image.header = read_header(reader);
  image.height = reader.value<std::uint32_t>();
  image.width = reader.value<std::uint32_t>();
  image.encoding = reader.text();
  image.is_big_endian = reader.value<std::uint8_t>() != 0;
  image.row_bytes = reader.value<std::uint32_t>();
  image.data = reader.blob();
  return image;
}

}  // namespace

Result<ImageMessage> decode_image(std::string_view bytes, MessageLayout layout, std::string_view what) {
  MessageReader reader(bytes, layout);
  ImageMessage image = read_image(reader);
  if (!reader.ok()) return cut_message(what);
  return image;
}

Result<DisparityMessage> decode_disparity(std::string_view bytes, MessageLayout layout, std::string_view what) {
  MessageReader reader(bytes, layout);
  DisparityMessage disparity;
  read_header(reader);
  disparity.image = read_image(reader);
  disparity.focal_length_px = reader.value<float>();
  disparity.baseline_m = reader.value<float>();
  for (int i = 0; i < 4; ++i) reader.value<std::uint32_t>();  // valid window
  reader.value<std::uint8_t>();                               // whether it is to be rectified
  disparity.min_disparity_px = reader.value<float>();
  disparity.max_disparity_px = reader.value<float>();
  if (!reader.ok()) return cut_message(what);
  return disparity;
}

Result<CompressedImageMessage> decode_compressed_image(std::string_view bytes, MessageLayout layout,
                                                       std::string_view what) {
  MessageReader reader(bytes, layout);
  CompressedImageMessage image;
  image.header = read_header(reader);
  image.format = reader.text();
  image.data = reader.blob();
  if (!reader.ok()) return cut_message(what);
  return image;
}

Result<ImageStart> decode_image_start(std::string_view bytes, const RecordedTopic& topic) {
  MessageReader reader(bytes, topic.layout);
  ImageStart start;
  start.header = read_header(reader);
  const bool is_disparity = topic.type == "stereo_msgs/DisparityImage";
  if (is_disparity) read_header(reader);  // of the image in it
  if (topic.type == "sensor_msgs/Image" || is_disparity) {
    reader.value<std::uint32_t>();
    reader.value<std::uint32_t>();
  }
  start.encoding = reader.text();
  if (!reader.ok()) return cut_message(topic.name);
  return start;
}

Result<CameraInfoMessage> decode_camera_info(std::string_view bytes, MessageLayout layout, std::string_view what) {
  MessageReader reader(bytes, layout);
  CameraInfoMessage info;
  info.header = read_header(reader);
  info.height = reader.value<std::uint32_t>();
  info.width = reader.value<std::uint32_t>();
  info.distortion_model = reader.text();
  const auto count = reader.value<std::uint32_t>();
  if (count > 64) return cut_message(what);
  for (std::uint32_t i = 0; i < count; ++i) info.distortion.push_back(reader.value<double>());
  for (double& value : info.k) value = reader.value<double>();
  for (int i = 0; i < 9; ++i) reader.value<double>();  // rectification
  for (double& value : info.p) value = reader.value<double>();
  if (!reader.ok()) return cut_message(what);
  return info;
}

bool holds_transforms(std::string_view type) {
  return type == "tf2_msgs/TFMessage" || type == "tf/tfMessage" || type == "nav_msgs/Odometry" ||
         type == "geometry_msgs/PoseStamped";
}

Result<std::vector<StampedTransform>> decode_transforms(std::string_view bytes, const RecordedTopic& topic) {
  MessageReader reader(bytes, topic.layout);
  std::vector<StampedTransform> transforms;
  const bool is_list = topic.type == "tf2_msgs/TFMessage" || topic.type == "tf/tfMessage";
  const bool has_child = topic.type != "geometry_msgs/PoseStamped";
  const std::uint32_t count = is_list ? reader.value<std::uint32_t>() : 1;
  for (std::uint32_t i = 0; i < count && reader.ok(); ++i) {
    const MessageHeader header = read_header(reader);
    const std::string child = has_child ? without_slash(reader.text()) : "";
    const auto pose = read_rigid(reader);
    if (reader.ok() && pose) transforms.push_back({header.stamp_ns, header.frame, child, *pose});
  }
  if (!reader.ok()) return cut_message(topic.name);
  return transforms;
}

Result<Rigid3> decode_plain_transform(std::string_view bytes, MessageLayout layout, std::string_view what) {
  MessageReader reader(bytes, layout);
  const auto pose = read_rigid(reader);
  if (!reader.ok() || !pose) return cut_message(what);
  return *pose;
}

Result<double> decode_float(std::string_view bytes, MessageLayout layout, std::string_view what) {
  MessageReader reader(bytes, layout);
  const auto value = reader.value<float>();
  if (!reader.ok()) return cut_message(what);
  return static_cast<double>(value);
}

}  // namespace resight
