// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cstdint>

#include "resight/core/image.hpp"
#include "resight/geometry/area_sums.hpp"

namespace resight {

/// Means of the distances between the surfaces of two views over squares of pixels. The noise of single pixels averages
/// out in them, so they show things that are only a few millimetres high, but larger than a square.
class MeanDistances {
 public:
  /// `distances`: of each pixel, in standard deviations of its noise; NaN: none. Those beyond `max_distance` do not
  /// count, so that a thing does not show in the squares beside it.
  MeanDistances(const Image<float>& distances, float max_distance);

  /// Mean over the square around a pixel, divided by the robust standard deviation of all such means. Errors of the
  /// poses make that larger, so they do not count as changes; it is at least that of independent noise. NaN if less
  /// than half of the square counts, or if fewer than 500 of the sampled squares have a mean.
  [[nodiscard]] float at(int u, int v) const;

 private:
  [[nodiscard]] float mean(int u, int v) const;

  int radius_px_;
  AreaSums<Eigen::Matrix<std::int64_t, 2, 1>> sums_;  ///< Of distances, and of ones.
  float scale_;                                       ///< Standard deviation of mean(); NaN: unknown.
};

}  // namespace resight
