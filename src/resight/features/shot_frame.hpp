// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <optional>

#include "resight/features/support_grid.hpp"

namespace resight {

/// Smallest share of the variance, l0 / (l0 + l1 + l2), of the neighbours around their mean; 0 for fewer than 3.
[[nodiscard]] double surface_variation(const Neighborhood& neighborhood, double noise_variance_sq_m = 0);

/// The local reference frame of SHOT (Tombari, Salti, Di Stefano 2010, sec. 3): rows are its x, y and z axis.
///
/// Eigenvectors (x: largest, z: smallest eigenvalue) of the covariance around the keypoint, weighted by radius -
/// distance; x and z point to the side of the majority of the neighbours; y = z cross x. Deviations: a tie is broken by
/// the sum of the weighted projections (the paper counts the points at the median distance), and there is no frame
/// where the axes or their signs are not defined: two like eigenvalues, an exact plane, a symmetric support.
[[nodiscard]] std::optional<Eigen::Matrix3f> local_reference_frame(const Neighborhood& neighborhood, double radius_m);

}  // namespace resight
