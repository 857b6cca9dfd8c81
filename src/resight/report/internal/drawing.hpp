// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "resight/core/image.hpp"
#include "resight/geometry/camera.hpp"
#include "resight/geometry/point_cloud.hpp"

namespace resight::report {

/// Closed pixel contours of the components of a shape.
using Outline = std::vector<std::vector<cv::Point>>;

enum class LineStyle { kSolid, kDashed, kDotted };

/// Wraps the image for OpenCV without copying. Channel order: red, green, blue.
[[nodiscard]] cv::Mat as_mat(Image<Rgb8>& image);
[[nodiscard]] cv::Scalar to_scalar(Rgb8 color);

/// Outline of the projection of a surface (object frame). Gaps between its points, which are `voxel_m` apart, are
/// closed. Empty if no part lies in front of the camera and within the image.
[[nodiscard]] Outline project_outline(const Camera& camera, const Rigid3& camera_from_object, const PointCloud& surface,
                                      double voxel_m);
[[nodiscard]] cv::Rect bounding_box(const Outline& outline);
/// Draws an outline; dashes and dots follow its pixels.
void draw_outline(cv::Mat& canvas, const Outline& outline, Rgb8 color, LineStyle style, int thickness_px);

/// Blends `color` into the pixels with non-zero `mask`.
void tint(Image<Rgb8>& image, const Image<std::uint8_t>& mask, Rgb8 color, double opacity);
/// Mask of the projected points, a small square each. Points behind the camera are skipped.
[[nodiscard]] Image<std::uint8_t> project_points(const Camera& camera, const Rigid3& camera_from_world,
                                                 const PointCloud& points_in_world);

/// Places text on coloured boxes that do not overlap as long as there is room.
class LabelPainter {
 public:
  explicit LabelPainter(cv::Mat& canvas) : canvas_(canvas) {}
  /// Draws the label above the box `target`, or at the nearest free position.
  void draw(const std::string& text, const cv::Rect& target, Rgb8 color);

 private:
  [[nodiscard]] cv::Rect find_room(const cv::Rect& wish) const;
  cv::Mat& canvas_;
  std::vector<cv::Rect> taken_;
};

}  // namespace resight::report
