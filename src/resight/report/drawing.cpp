// SPDX-License-Identifier: Apache-2.0
#include "resight/report/internal/drawing.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace resight::report {
namespace {

constexpr float kMinDepth_m = 0.05F;
// Removed points come from clouds downsampled to 5 mm.
constexpr double kRemovedPointSize_m = 0.005;
// Limits the size of points just in front of the lens.
constexpr int kMaxSplat_px = 24;

void fill_square(Image<std::uint8_t>& mask, float u, float v, int radius) {
  // Coordinates far outside are dropped before the conversion to int, which could not represent them.
  const float limit = static_cast<float>(std::max(mask.width(), mask.height()) + kMaxSplat_px);
  if (!(std::abs(u) < limit + limit) || !(std::abs(v) < limit + limit)) return;
  const int cu = static_cast<int>(std::lround(u));
  const int cv = static_cast<int>(std::lround(v));
  const int left = std::max(0, cu - radius);
  const int right = std::min(mask.width() - 1, cu + radius);
  for (int row = std::max(0, cv - radius); row <= std::min(mask.height() - 1, cv + radius); ++row) {
    for (int column = left; column <= right; ++column) mask(column, row) = 255;
  }
}

/// Half the side, in pixels, of a square that covers `size_m` at the mean depth of the points in front of the camera.
int splat_radius_px(const Camera& camera, const Rigid3f& camera_from_cloud, const PointCloud& cloud, double size_m) {
  double depth_sum_m = 0;
  int count = 0;
  for (const Eigen::Vector3f& point : cloud.points) {
    const float z = (camera_from_cloud * point).z();
    if (!(z > kMinDepth_m)) continue;
    depth_sum_m += z;
    ++count;
  }
  if (count == 0) return 0;
  return static_cast<int>(std::min<double>(kMaxSplat_px, std::ceil(0.5 * camera.fx * size_m * count / depth_sum_m)));
}

/// Marks a square at the projection of each point.
Image<std::uint8_t> splat(const Camera& camera, const Rigid3f& camera_from_cloud, const PointCloud& cloud,
                          int radius_px) {
  Image<std::uint8_t> mask(camera.width, camera.height, 0);
  const auto fx = static_cast<float>(camera.fx);
  const auto fy = static_cast<float>(camera.fy);
  for (const Eigen::Vector3f& point : cloud.points) {
    const Eigen::Vector3f p = camera_from_cloud * point;
    if (!(p.z() > kMinDepth_m)) continue;
    fill_square(mask, fx * p.x() / p.z() + static_cast<float>(camera.cx),
                fy * p.y() / p.z() + static_cast<float>(camera.cy), radius_px);
  }
  return mask;
}

int dash_length_px(LineStyle style) { return style == LineStyle::kDashed ? 7 : 2; }

double text_scale(const cv::Mat& canvas) { return 0.42 * std::max(1.0, canvas.cols / 640.0); }

bool is_light(Rgb8 color) { return 0.299 * color.r + 0.587 * color.g + 0.114 * color.b > 140; }

}  // namespace

cv::Mat as_mat(Image<Rgb8>& image) {
  static_assert(sizeof(Rgb8) == 3, "rows of Rgb8 are rows of three channels");
  return cv::Mat(image.height(), image.width(), CV_8UC3, image.data().data());
}

cv::Scalar to_scalar(Rgb8 color) { return cv::Scalar(color.r, color.g, color.b); }

Outline project_outline(const Camera& camera, const Rigid3& camera_from_object, const PointCloud& surface,
                        double voxel_m) {
  const Rigid3f motion(camera_from_object);
  const int radius_px = splat_radius_px(camera, motion, surface, voxel_m);
  Image<std::uint8_t> mask = splat(camera, motion, surface, radius_px);
  cv::Mat mask_mat(mask.height(), mask.width(), CV_8UC1, mask.data().data());
  const cv::Mat disc = cv::getStructuringElement(cv::MORPH_ELLIPSE, cv::Size(5, 5));
  cv::morphologyEx(mask_mat, mask_mat, cv::MORPH_CLOSE, disc);
  // The squares extend beyond the outermost points; erosion puts the outline back on the object's border.
  const cv::Mat square = cv::getStructuringElement(cv::MORPH_RECT, cv::Size(2 * radius_px + 1, 2 * radius_px + 1));
  cv::erode(mask_mat, mask_mat, square);
  Outline outline;
  cv::findContours(mask_mat, outline, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
  return outline;
}

cv::Rect bounding_box(const Outline& outline) {
  cv::Rect box;
  for (const auto& line : outline) {
    const cv::Rect part = cv::boundingRect(line);
    box = box.empty() ? part : (box | part);
  }
  return box;
}

void draw_outline(cv::Mat& canvas, const Outline& outline, Rgb8 color, LineStyle style, int thickness_px) {
  if (style == LineStyle::kSolid) {
    cv::polylines(canvas, outline, true, to_scalar(color), thickness_px, cv::LINE_AA);
    return;
  }
  const std::size_t dash = static_cast<std::size_t>(dash_length_px(style));
  for (const auto& line : outline) {
    for (std::size_t start = 0; start < line.size(); start += 2 * dash) {
      const std::size_t end = std::min(start + dash, line.size() - 1);
      cv::line(canvas, line[start], line[end], to_scalar(color), thickness_px, cv::LINE_AA);
    }
  }
}

void tint(Image<Rgb8>& image, const Image<std::uint8_t>& mask, Rgb8 color, double opacity) {
  const auto mix = [opacity](std::uint8_t from, std::uint8_t to) {
    return static_cast<std::uint8_t>(std::lround((1 - opacity) * from + opacity * to));
  };
  for (std::size_t i = 0; i < image.size(); ++i) {
    if (mask[i] != 0) image[i] = {mix(image[i].r, color.r), mix(image[i].g, color.g), mix(image[i].b, color.b)};
  }
}

Image<std::uint8_t> project_points(const Camera& camera, const Rigid3& camera_from_world,
                                   const PointCloud& points_in_world) {
  const Rigid3f motion(camera_from_world);
  return splat(camera, motion, points_in_world, splat_radius_px(camera, motion, points_in_world, kRemovedPointSize_m));
}

void LabelPainter::draw(const std::string& text, const cv::Rect& target, Rgb8 color) {
  const double scale = text_scale(canvas_);
  int baseline = 0;
  const cv::Size size = cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, scale, 1, &baseline);
  const int pad = 3;
  const int height = size.height + baseline + 2 * pad;
  const cv::Rect box = find_room({target.x, target.y - height - 2, size.width + 2 * pad, height});
  cv::rectangle(canvas_, box, to_scalar(color), cv::FILLED);
  const Rgb8 ink = is_light(color) ? Rgb8{0, 0, 0} : Rgb8{255, 255, 255};
  cv::putText(canvas_, text, {box.x + pad, box.y + pad + size.height}, cv::FONT_HERSHEY_SIMPLEX, scale, to_scalar(ink),
              1, cv::LINE_AA);
  taken_.push_back(box);
}

cv::Rect LabelPainter::find_room(const cv::Rect& wish) const {
  const auto clamped = [this](cv::Rect box) {
    box.x = std::clamp(box.x, 0, std::max(0, canvas_.cols - box.width));
    box.y = std::clamp(box.y, 0, std::max(0, canvas_.rows - box.height));
    return box;
  };
  const auto is_free = [this](const cv::Rect& box) {
    return std::none_of(taken_.begin(), taken_.end(), [&](const cv::Rect& other) { return !(box & other).empty(); });
  };
  for (int step = 0; step < 24; ++step) {
    for (const int direction : {-1, 1}) {
      cv::Rect box = wish;
      box.y += direction * step * (wish.height + 1) / 2;
      box = clamped(box);
      if (is_free(box)) return box;
    }
  }
  return clamped(wish);
}

}  // namespace resight::report
