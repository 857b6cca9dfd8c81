// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string_view>

#include "resight/core/image.hpp"
#include "resight/core/result.hpp"
#include "resight/recordings/recording.hpp"

namespace resight::io {

/// What images of an encoding (sensor_msgs/Image) or a format (CompressedImage) are.
enum class ImageContent { kColor, kDepth, kUnknown };
/// `topic_name` decides for mono16, which is used for depth and for infrared.
[[nodiscard]] ImageContent content_of(std::string_view encoding, std::string_view topic_name);

/// Decodes a message of a colour topic.
[[nodiscard]] Result<Image<Rgb8>> decode_color_message(std::string_view bytes, const RecordedTopic& topic);

/// Decodes a message of a depth topic. Whole numbers are multiplied by `metres_per_unit` (millimetres if not given),
/// and floating-point metres only if it is given. Depth that is not positive and finite becomes NaN, and so does the
/// largest whole number.
[[nodiscard]] Result<Image<float>> decode_depth_message(std::string_view bytes, const RecordedTopic& topic,
                                                        std::optional<double> metres_per_unit);

}  // namespace resight::io
