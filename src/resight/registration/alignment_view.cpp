// SPDX-License-Identifier: Apache-2.0
#include "resight/registration/alignment_view.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "resight/core/check.hpp"
#include "resight/sensor/surface_color.hpp"

namespace resight {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr int kMinWidth = 40;  // Narrower levels hold too little to align.

Image<float> to_grey(const Image<Rgb8>& color) {
  Image<float> grey(color.width(), color.height());
  for (std::size_t i = 0; i < grey.size(); ++i)  // Rec. 601, as for the grey images of SIFT.
    grey[i] = 0.299F * color[i].r + 0.587F * color[i].g + 0.114F * color[i].b;
  return grey;
}

// Smooths the image with the kernel 1 4 6 4 1 and keeps every second pixel (Burt and Adelson 1983). Pixel (u, v) of the
// result coincides with pixel (2u, 2v) of the input, as in the point images.
Image<float> halve(const Image<float>& image) {
  constexpr std::array<float, 5> kWeights{0.0625F, 0.25F, 0.375F, 0.25F, 0.0625F};
  const int width = image.width() / 2;
  const int height = image.height() / 2;
  Image<float> rows(width, image.height());
  for (int v = 0; v < image.height(); ++v)
    for (int u = 0; u < width; ++u)
      for (int k = 0; k < 5; ++k)
        rows(u, v) += kWeights[static_cast<std::size_t>(k)] * image(std::clamp(2 * u - 2 + k, 0, image.width() - 1), v);
  Image<float> half(width, height);
  for (int v = 0; v < height; ++v)
    for (int k = 0; k < 5; ++k) {
      const auto from = rows.row(std::clamp(2 * v - 2 + k, 0, image.height() - 1));
      const auto to = half.row(v);
      for (int u = 0; u < width; ++u) to[u] += kWeights[static_cast<std::size_t>(k)] * from[u];
    }
  return half;
}

// Mean over (2 radius + 1)^2 pixels; fewer at the image border.
Image<float> box_mean(const Image<float>& image, int radius) {
  const int width = image.width();
  const int height = image.height();
  Image<double> sums(width + 1, height + 1);
  for (int v = 0; v < height; ++v) {
    double row = 0;
    for (int u = 0; u < width; ++u) {
      row += image(u, v);
      sums(u + 1, v + 1) = sums(u + 1, v) + row;
    }
  }
  Image<float> mean(width, height);
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u) {
      const int left = std::max(u - radius, 0), right = std::min(u + radius + 1, width);
      const int top = std::max(v - radius, 0), bottom = std::min(v + radius + 1, height);
      const double sum = sums(right, bottom) - sums(left, bottom) - sums(right, top) + sums(left, top);
      mean(u, v) = static_cast<float>(sum / ((right - left) * (bottom - top)));
    }
  return mean;
}

// Camera of the image whose pixel (u, v) is pixel (2u, 2v) of the finer one.
Camera subsample(const Camera& camera) {
  return {camera.width / 2, camera.height / 2, camera.fx / 2, camera.fy / 2,
          camera.cx / 2,    camera.cy / 2,     camera.noise};
}

Image<float> without_mean(Image<float> grey, double mean_radius) {
  const Image<float> mean = box_mean(grey, std::max(1, static_cast<int>(std::lround(mean_radius * grey.width()))));
  for (std::size_t i = 0; i < grey.size(); ++i) grey[i] -= mean[i];
  return grey;
}

// The points of each `step`-th pixel; `brightness` has the size of the result. Depths are never averaged: a mean across
// an edge lies on no surface.
Image<AlignmentPoint> sample_points(const PreparedView& view, int step, const Image<float>& brightness,
                                    const AlignmentViewOptions& options, const Image<std::uint8_t>* mask) {
  const auto min_edge_distance_px = static_cast<float>(options.min_edge_distance_px);
  Image<AlignmentPoint> points(brightness.width(), brightness.height());
  for (int v = 0; v < points.height(); ++v)
    for (int u = 0; u < points.width(); ++u) {
      const std::size_t i = view.cloud.z.index(step * u, step * v);
      const bool is_aligned = view.edge_distance_px[i] >= min_edge_distance_px && (mask == nullptr || (*mask)[i] != 0);
      points(u, v) = {.position = view.cloud.point(i),
                      .sigma_m = view.noise.axial_m[i],
                      .normal = is_aligned ? view.cloud.normal(i) : Eigen::Vector3f::Constant(kNan),
                      .brightness = brightness(u, v)};
    }
  return points;
}

}  // namespace

void AlignmentViewOptions::check() const {
  check_in_range("num_levels", num_levels, 1, 8);
  check_not_negative("min_edge_distance_px", min_edge_distance_px);
  check_positive("mean_radius", mean_radius);
}

AlignmentView make_alignment_view(const PreparedView& view, const AlignmentViewOptions& options,
                                  const Image<std::uint8_t>* mask) {
  options.check();
  require(mask == nullptr || (mask->width() == view.cloud.width() && mask->height() == view.cloud.height()),
          "mask: must have the size of the view");
  require(!view.cloud.nx.empty(), "view: must have normals");
  // Halving leaves this share of the noise: the sum of the squared weights of halve().
  constexpr double kHalvedNoise = 70.0 / 256.0;
  AlignmentView pyramid;
  pyramid.brightness_noise = kHalvedNoise * estimate_image_noise(view.frame.color);
  Camera camera = view.frame.camera;
  Image<float> grey = to_grey(view.frame.color);
  for (int l = 0; l < options.num_levels && camera.width / 2 >= kMinWidth; ++l) {
    camera = subsample(camera);
    grey = halve(grey);
    pyramid.levels.push_back(
        {camera, sample_points(view, 2 << l, without_mean(grey, options.mean_radius), options, mask)});
  }
  return pyramid;
}

}  // namespace resight
