// SPDX-License-Identifier: Apache-2.0
#include "resight/features/sift.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <span>
#include <tuple>

#include "resight/core/check.hpp"

namespace resight {
namespace {

constexpr int kDimension = 128;
// OpenCV halves the coordinates found in the doubled image, whose pixel centres lie at (u - 0.5) / 2 of the image. Its
// keypoints are therefore a quarter pixel too far right and down (measured on blobs at known places, OpenCV 4.6).
constexpr double kDoublingShift_px = 0.25;

cv::Mat grey_image(const Image<Rgb8>& color) {
  static_assert(sizeof(Rgb8) == 3);
  // OpenCV has no view of constant data; this one is only read.
  const cv::Mat rgb(color.height(), color.width(), CV_8UC3, const_cast<Rgb8*>(color.data().data()));
  cv::Mat grey;
  cv::cvtColor(rgb, grey, cv::COLOR_RGB2GRAY);
  return grey;
}

/// Pixels that may contain a keypoint. The detector uses them to avoid describing others.
cv::Mat usable_pixels(const OrganizedCloud& cloud, const Image<std::uint8_t>* mask) {
  cv::Mat usable(cloud.height(), cloud.width(), CV_8UC1);
  for (int v = 0; v < cloud.height(); ++v) {
    auto* row = usable.ptr<std::uint8_t>(v);
    for (int u = 0; u < cloud.width(); ++u) {
      const std::size_t i = cloud.z.index(u, v);
      row[u] = cloud.has_normal(i) && (mask == nullptr || (*mask)[i] != 0) ? 255 : 0;
    }
  }
  // Because of the shift of OpenCV's keypoints, the detector may query the pixel right of (below) the nearest one.
  cv::dilate(usable, usable, cv::Mat::ones(2, 2, CV_8UC1), cv::Point(1, 1));
  return usable;
}

/// Row indices of keypoints in a total order, independent of the threads of the detector.
std::vector<int> reading_order(const std::vector<cv::KeyPoint>& keypoints) {
  std::vector<int> order(keypoints.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int>(i);
  const auto key = [&](int i) {
    const cv::KeyPoint& k = keypoints[i];
    return std::make_tuple(k.pt.y, k.pt.x, k.size, k.angle, k.octave, k.response);
  };
  std::ranges::stable_sort(order, [&](int a, int b) { return key(a) < key(b); });
  return order;
}

/// Scales a descriptor to unit L2 norm (RootSIFT: L1 norm and square root). Returns false if it is zero.
bool normalize(bool root_sift, std::span<float> descriptor) {
  double sum = 0;
  // SIFT has no negative components.
  for (const float x : descriptor) sum += root_sift ? x : static_cast<double>(x) * x;
  if (!(sum > 0)) return false;
  for (float& x : descriptor) x = static_cast<float>(root_sift ? std::sqrt(x / sum) : x / std::sqrt(sum));
  return true;
}

}  // namespace

FeatureSet extract_sift(const PreparedView& view, const SiftOptions& options, const Image<std::uint8_t>* mask) {
  options.check();
  const OrganizedCloud& cloud = view.cloud;
  const Image<Rgb8>& color = view.frame.color;
  require(color.width() == cloud.width() && color.height() == cloud.height(),
          "extract_sift: the colour image must have the size of the cloud");
  require(mask == nullptr || (mask->width() == cloud.width() && mask->height() == cloud.height()),
          "extract_sift: the mask must have the size of the camera image");
  FeatureSet features;
  features.type = FeatureType::kSift;
  features.dimension = kDimension;

  std::vector<cv::KeyPoint> keypoints;
  cv::Mat descriptors;
  cv::SIFT::create(0, options.num_octave_layers, options.contrast_threshold, options.edge_threshold)
      ->detectAndCompute(grey_image(color), usable_pixels(cloud, mask), keypoints, descriptors);
  for (const int row : reading_order(keypoints)) {
    const double u = keypoints[row].pt.x - kDoublingShift_px;
    const double v = keypoints[row].pt.y - kDoublingShift_px;
    const std::optional<Pixel> nearest = view.frame.camera.pixel_at({u, v});
    if (!nearest) continue;
    const std::size_t pixel = cloud.z.index(nearest->u, nearest->v);
    if (!cloud.has_normal(pixel) || (mask != nullptr && (*mask)[pixel] == 0)) continue;
    const auto* values = descriptors.ptr<float>(row);
    const std::size_t begin = features.descriptors.size();
    features.descriptors.insert(features.descriptors.end(), values, values + kDimension);
    if (!normalize(options.root_sift, std::span(features.descriptors).subspan(begin))) {
      features.descriptors.resize(begin);
      continue;
    }
    features.points.push_back(view.frame.camera.unproject(u, v, cloud.z[pixel]).cast<float>());
    features.normals.push_back(cloud.normal(pixel));
  }
  return features;
}

}  // namespace resight
