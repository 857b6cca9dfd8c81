// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <optional>

#include "resight/features/support_grid.hpp"

namespace resight {

/// Smallest share of the variance, l0 / (l0 + l1 + l2), of the neighbours around their mean; 0 for fewer than 3
/// neighbours. `noise_variance_sq_m` is subtracted from l0 first.
[[nodiscard]] double surface_variation(const Neighborhood& neighborhood, double noise_variance_sq_m = 0);

/// The local reference frame of SHOT (Tombari, Salti, Di Stefano 2010, sec. 3). The rows are its x, y and z axes.
///
/// The axes are eigenvectors (x: largest, z: smallest eigenvalue) of the covariance around the keypoint, weighted by
/// radius - distance. x and z point to the side with the majority of the neighbours; y = z cross x. Deviations: the sum
/// of the weighted projections breaks a tie (the paper counts the points at the median distance), and there is no frame
/// if the axes or their signs are undefined: two similar eigenvalues, an exact plane, or a symmetric support.
[[nodiscard]] std::optional<Eigen::Matrix3f> local_reference_frame(const Neighborhood& neighborhood, double radius_m);

}  // namespace resight
