// SPDX-License-Identifier: Apache-2.0
#include "resight/features/shot.hpp"

#include <algorithm>

#include "resight/core/check.hpp"
#include "resight/core/parallel.hpp"
#include "resight/features/shot_frame.hpp"
#include "resight/features/shot_histogram.hpp"
#include "resight/features/support_grid.hpp"
#include "resight/features/uniform_sampling.hpp"

namespace resight {
namespace {

constexpr std::size_t kKeypointsPerTask = 64;

/// Descriptors of a block of keypoints.
struct Described {
  std::vector<int> keypoints;
  std::vector<float> descriptors;
};

/// Buffers that are reused from keypoint to keypoint.
class Describer {
 public:
  Describer(const SupportGrid& grid, const ShotOptions& options) : grid_(grid), options_(options) {}

  /// Appends the descriptor of `keypoint`; returns false if it has none.
  bool describe(const Eigen::Vector3f& keypoint, double noise_variance_sq_m, std::vector<float>& descriptors) {
    if (!keypoint.allFinite()) return false;
    grid_.gather(keypoint, neighborhood_);
    if (neighborhood_.count < options_.min_neighbors) return false;
    if (options_.min_surface_variation > 0 &&
        surface_variation(neighborhood_, noise_variance_sq_m) < options_.min_surface_variation)
      return false;
    const std::optional<Eigen::Matrix3f> frame = local_reference_frame(neighborhood_, options_.support_radius_m);
    if (!frame) return false;
    const std::size_t begin = descriptors.size();
    descriptors.resize(begin + kShotDimension);
    histogram_.compute(neighborhood_, *frame, options_.support_radius_m, std::span(descriptors).subspan(begin));
    return true;
  }

 private:
  const SupportGrid& grid_;
  const ShotOptions& options_;
  Neighborhood neighborhood_;
  ShotHistogram histogram_;
};

// `noise_variance_sq_m` is the variance of the measurement at each keypoint; empty means none.
std::vector<Described> describe_in_blocks(const PointCloud& support, const PointCloud& keypoints,
                                          std::span<const double> noise_variance_sq_m, const ShotOptions& options) {
  const SupportGrid grid(support, options.support_radius_m);
  std::vector<Described> blocks((keypoints.size() + kKeypointsPerTask - 1) / kKeypointsPerTask);
  parallel_for_blocks(
      keypoints.size(), kKeypointsPerTask, options.num_threads, [&](std::size_t begin, std::size_t end) {
        Describer describer(grid, options);
        Described& block = blocks[begin / kKeypointsPerTask];
        for (std::size_t i = begin; i < end; ++i)
          if (describer.describe(keypoints.points[i], noise_variance_sq_m.empty() ? 0.0 : noise_variance_sq_m[i],
                                 block.descriptors))
            block.keypoints.push_back(static_cast<int>(i));
      });
  return blocks;
}

/// The downsampled points that have normals (within the mask).
PointCloud support_of_view(const PreparedView& view, const ShotOptions& options, const Image<std::uint8_t>* mask) {
  std::vector<int> pixels;
  PointCloud surface = to_point_cloud(view.cloud, nullptr, true, &pixels);
  if (mask != nullptr) {
    std::vector<int> inside;
    for (std::size_t i = 0; i < pixels.size(); ++i)
      if ((*mask)[pixels[i]] != 0) inside.push_back(static_cast<int>(i));
    surface = select(surface, inside);
  }
  return options.support_voxel_m ? voxel_downsample(surface, *options.support_voxel_m) : surface;
}

FeatureSet describe(const PointCloud& support, const PointCloud& keypoints, std::span<const double> noise_variance_sq_m,
                    const ShotOptions& options, std::vector<int>* kept) {
  FeatureSet features;
  features.type = FeatureType::kShot;
  features.dimension = kShotDimension;
  if (kept != nullptr) kept->clear();
  const std::vector<Described> blocks = describe_in_blocks(support, keypoints, noise_variance_sq_m, options);
  std::size_t num_described = 0;
  for (const Described& block : blocks) num_described += block.keypoints.size();
  features.points.reserve(num_described);
  features.normals.reserve(num_described);
  features.descriptors.reserve(num_described * kShotDimension);
  for (const Described& block : blocks) {
    for (const int i : block.keypoints) {
      features.points.push_back(keypoints.points[i]);
      features.normals.push_back(keypoints.normals[i]);
    }
    features.descriptors.insert(features.descriptors.end(), block.descriptors.begin(), block.descriptors.end());
    if (kept != nullptr) kept->insert(kept->end(), block.keypoints.begin(), block.keypoints.end());
  }
  return features;
}

}  // namespace

FeatureSet describe_shot(const PointCloud& support, const PointCloud& keypoints, const ShotOptions& options,
                         std::vector<int>* kept) {
  options.check();
  require(support.empty() || support.has_normals(), "describe_shot: the support has no normals");
  require(keypoints.empty() || keypoints.has_normals(), "describe_shot: the keypoints have no normals");
  return describe(support, keypoints, {}, options, kept);
}

FeatureSet extract_shot(const PreparedView& view, const ShotOptions& options, const Image<std::uint8_t>* mask) {
  options.check();
  require(!view.cloud.nx.empty(), "extract_shot: the view has no normals");
  require(mask == nullptr || (mask->width() == view.cloud.width() && mask->height() == view.cloud.height()),
          "extract_shot: the mask must have the size of the camera image");
  const PointCloud support = support_of_view(view, options, mask);
  std::vector<int> indices = sample_uniformly(support.points, options.keypoint_spacing_m);
  if (options.max_keypoint_depth_m)
    std::erase_if(indices, [&](int i) { return support.points[i].z() > *options.max_keypoint_depth_m; });
  std::vector<double> noise_variance_sq_m;
  for (const int i : indices) {
    const double sigma_m = axial_noise_m(view.frame.camera.noise, support.points[i].z());
    noise_variance_sq_m.push_back(sigma_m * sigma_m);
  }
  return describe(support, select(support, indices), noise_variance_sq_m, options, nullptr);
}

}  // namespace resight
