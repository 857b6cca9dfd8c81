// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

#include "resight/features/support_grid.hpp"

namespace resight {

inline constexpr int kShotCosineBins = 11;
inline constexpr int kShotDimension = 32 * kShotCosineBins;

/// Fills the histograms of SHOT: for each of 32 volumes (8 azimuths x 2 radii x 2 elevations) 11 bins of the cosine
/// between a neighbour's normal and the frame's z axis. Volume = 4 * azimuth + 2 * (outer half) + (above), azimuth from
/// -pi on.
///
/// Each neighbour votes, as in the authors' code, in each of the four dimensions for its own bin by 1 - d and for the
/// next one by d, where d is its distance to the centre of its bin in bins; off the ends of a dimension (azimuth has
/// none) the second vote is lost. Deviation from PCL: the cosine does not wrap around from its last bin to its first.
class ShotHistogram {
 public:
  /// `descriptor`: kShotDimension values, of unit L2 norm afterwards. `frame`: rows are its axes.
  void compute(const Neighborhood& neighborhood, const Eigen::Matrix3f& frame, double radius_m,
               std::span<float> descriptor);

 private:
  void locate(const Neighborhood& neighborhood, const Eigen::Matrix3f& frame, float radius_m);
  void add_votes(std::size_t neighbor, float* descriptor) const;

  /// Coordinates of each neighbour in bins (their centres are whole numbers), split into bin and signed offset from its
  /// centre.
  std::vector<int> azimuth_bin_, radial_bin_, elevation_bin_, cosine_bin_;
  std::vector<float> azimuth_, radial_, elevation_, cosine_;
};

}  // namespace resight
