// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "resight/core/result.hpp"
#include "resight/geometry/rigid3.hpp"
#include "resight/recordings/recording.hpp"

/// The messages that are read, as plain structures. The decoders take the bytes of one message; `what` starts the error
/// message. Texts are as in the file.
namespace resight {

struct MessageHeader {
  std::int64_t stamp_ns = 0;
  std::string frame;
};

/// sensor_msgs/Image. `data` borrows the bytes of the message.
struct ImageMessage {
  MessageHeader header;
  std::uint32_t height = 0;
  std::uint32_t width = 0;
  std::string encoding;
  bool is_big_endian = false;
  std::uint32_t row_bytes = 0;
  std::string_view data;
};

/// sensor_msgs/CompressedImage. `data` borrows the bytes of the message.
struct CompressedImageMessage {
  MessageHeader header;
  std::string format;  ///< Such as "jpeg" or "16UC1; compressedDepth png".
  std::string_view data;
};

/// stereo_msgs/DisparityImage: the depth is focal_length_px * baseline_m / disparity.
struct DisparityMessage {
  ImageMessage image;  ///< Of disparities, px.
  double focal_length_px = 0;
  double baseline_m = 0;
  double min_disparity_px = 0;  ///< Smaller and larger ones are not measured.
  double max_disparity_px = 0;
};

/// sensor_msgs/CameraInfo.
struct CameraInfoMessage {
  MessageHeader header;
  std::uint32_t height = 0;
  std::uint32_t width = 0;
  std::string distortion_model;
  std::vector<double> distortion;
  std::array<double, 9> k{};
  std::array<double, 12> p{};
};

/// One transform of tf2_msgs/TFMessage, or a pose: parent_from_child.
struct StampedTransform {
  std::int64_t stamp_ns = 0;
  std::string parent;
  std::string child;  ///< Empty for a PoseStamped.
  Rigid3 parent_from_child;
};

[[nodiscard]] Result<ImageMessage> decode_image(std::string_view bytes, MessageLayout layout, std::string_view what);
[[nodiscard]] Result<CompressedImageMessage> decode_compressed_image(std::string_view bytes, MessageLayout layout,
                                                                     std::string_view what);
[[nodiscard]] Result<DisparityMessage> decode_disparity(std::string_view bytes, MessageLayout layout,
                                                        std::string_view what);
/// Header and encoding (or format) of one of the three, from the first bytes of a message.
struct ImageStart {
  MessageHeader header;
  std::string encoding;
};
inline constexpr std::size_t kImageStartBytes = 1024;
[[nodiscard]] Result<ImageStart> decode_image_start(std::string_view bytes, const RecordedTopic& topic);

[[nodiscard]] Result<CameraInfoMessage> decode_camera_info(std::string_view bytes, MessageLayout layout,
                                                           std::string_view what);

/// Whether decode_transforms() reads messages of this type: tf2_msgs/TFMessage, tf/tfMessage, nav_msgs/Odometry,
/// geometry_msgs/PoseStamped.
[[nodiscard]] bool holds_transforms(std::string_view type);
/// Transforms that are no rigid motions are left out.
[[nodiscard]] Result<std::vector<StampedTransform>> decode_transforms(std::string_view bytes,
                                                                      const RecordedTopic& topic);
/// geometry_msgs/Transform without frames, and std_msgs/Float32: in recordings of librealsense.
[[nodiscard]] Result<Rigid3> decode_plain_transform(std::string_view bytes, MessageLayout layout,
                                                    std::string_view what);
[[nodiscard]] Result<double> decode_float(std::string_view bytes, MessageLayout layout, std::string_view what);

}  // namespace resight
