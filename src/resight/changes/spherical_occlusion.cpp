// SPDX-License-Identifier: Apache-2.0
#include "resight/changes/spherical_occlusion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "resight/core/check.hpp"
#include "resight/core/parallel.hpp"

namespace resight {
namespace {

constexpr std::size_t kQueriesPerTask = 4096;
constexpr float kNoBlocker = std::numeric_limits<float>::infinity();

/// Range of the nearest blocker of each bin; infinity for an empty one.
std::vector<float> fill_z_buffer(std::span<const Eigen::Vector3f> blockers, const SphericalBins& bins,
                                 int num_threads) {
  std::vector<int> bin(blockers.size());
  parallel_for_blocks(blockers.size(), kQueriesPerTask, num_threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) bin[i] = bins.bin(blockers[i]);
  });
  std::vector<float> nearest_sq(bins.num_bins(), kNoBlocker);
  for (std::size_t i = 0; i < blockers.size(); ++i)
    if (bin[i] >= 0) nearest_sq[bin[i]] = std::min(nearest_sq[bin[i]], blockers[i].squaredNorm());
  for (float& value : nearest_sq) value = std::sqrt(value);
  return nearest_sq;
}

}  // namespace

std::vector<Evidence> classify_occlusion(std::span<const Eigen::Vector3f> queries_in_camera,
                                         std::span<const Eigen::Vector3f> blockers_in_camera, const SphericalBins& bins,
                                         double margin_m, int num_threads) {
  check_not_negative("margin_m", margin_m);
  const std::vector<float> nearest_m = fill_z_buffer(blockers_in_camera, bins, num_threads);
  const auto margin = static_cast<float>(margin_m);
  std::vector<Evidence> evidence(queries_in_camera.size(), Evidence::kUnobserved);
  parallel_for_blocks(queries_in_camera.size(), kQueriesPerTask, num_threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const int bin = bins.bin(queries_in_camera[i]);
      if (bin < 0 || nearest_m[bin] == kNoBlocker) continue;
      const bool hidden = nearest_m[bin] < queries_in_camera[i].norm() - margin;
      evidence[i] = hidden ? Evidence::kOccluded : Evidence::kSeenThrough;
    }
  });
  return evidence;
}

}  // namespace resight
