// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "resight/core/image.hpp"
#include "resight/geometry/camera.hpp"
#include "resight/geometry/point_cloud.hpp"

namespace resight::report {

/// Closed pixel lines around the parts of a shape, pixel by pixel.
using Outline = std::vector<std::vector<cv::Point>>;

enum class LineStyle { kSolid, kDashed, kDotted };

/// The image as OpenCV sees it, in the same memory and in the order red, green, blue.
[[nodiscard]] cv::Mat as_mat(Image<Rgb8>& image);
[[nodiscard]] cv::Scalar to_scalar(Rgb8 color);

/// Outline of a surface (object frame) as it projects into the image; gaps between its points, `voxel_m` apart, are
/// closed. Empty where nothing of it lies before the camera and within the image.
[[nodiscard]] Outline project_outline(const Camera& camera, const Rigid3& camera_from_object, const PointCloud& surface,
                                      double voxel_m);
[[nodiscard]] cv::Rect bounding_box(const Outline& outline);
void draw_outline(cv::Mat& canvas, const Outline& outline, Rgb8 color, LineStyle style, int thickness_px);

/// Mixes `color` into the pixels where `mask` is set.
void tint(Image<Rgb8>& image, const Image<std::uint8_t>& mask, Rgb8 color, double opacity);
/// Non-zero where a point projects, a small square each; points behind the camera are left out.
[[nodiscard]] Image<std::uint8_t> project_points(const Camera& camera, const Rigid3& camera_from_world,
                                                 const PointCloud& points_in_world);

/// Places text on coloured boxes so that they do not cover each other as long as there is room.
class LabelPainter {
 public:
  explicit LabelPainter(cv::Mat& canvas) : canvas_(canvas) {}
  /// Above the box `target`, or as near to that as is free.
  void draw(const std::string& text, const cv::Rect& target, Rgb8 color);

 private:
  [[nodiscard]] cv::Rect find_room(const cv::Rect& wish) const;
  cv::Mat& canvas_;
  std::vector<cv::Rect> taken_;
};

}  // namespace resight::report
