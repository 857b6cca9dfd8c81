// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

#include "resight/features/support_grid.hpp"

namespace resight {

/// Bins of the cosine per volume, and the length of the descriptor.
inline constexpr int kShotCosineBins = 11;
inline constexpr int kShotDimension = 32 * kShotCosineBins;

/// Computes the histograms of SHOT. Each of 32 volumes (8 azimuths x 2 radii x 2 elevations) has 11 bins of the cosine
/// between the normal of a neighbour and the z axis of the frame. The volume index is 4 * azimuth + 2 * (outer half) +
/// (above), with azimuth starting at -pi.
///
/// As in the authors' code, each neighbour votes in each of the four dimensions for its own bin with 1 - d and for the
/// next bin with d, where d is the distance to the centre of its bin in bins. Beyond the ends of a dimension (azimuth
/// has none), the second vote is lost. Deviation from PCL: the cosine does not wrap from its last bin to its first.
class ShotHistogram {
 public:
  /// `descriptor` receives kShotDimension values of unit L2 norm. The rows of `frame` are its axes.
  void compute(const Neighborhood& neighborhood, const Eigen::Matrix3f& frame, double radius_m,
               std::span<float> descriptor);

 private:
  void locate(const Neighborhood& neighborhood, const Eigen::Matrix3f& frame, float radius_m);
  void add_votes(std::size_t neighbor, float* descriptor) const;

  /// Coordinates of each neighbour in bins, whose centres are at whole numbers: bin and signed offset from its centre.
  std::vector<int> azimuth_bin_, radial_bin_, elevation_bin_, cosine_bin_;
  std::vector<float> azimuth_, radial_, elevation_, cosine_;
};

}  // namespace resight
