// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

#include "resight/evidence/surface_evidence.hpp"
#include "resight/geometry/spherical_bins.hpp"

namespace resight {

/// The paper's spherical z-buffer. Queries and blockers: metres, camera frame, NaN = no measurement. For each query:
/// kOccluded if the nearest blocker of its bin is nearer by more than `margin_m` (ranges, not depths); kSeenThrough if
/// the bin has blockers, but none so near; kUnobserved if the bin is empty, or for NaN: no return is no evidence.
/// kPresent does not occur. Sec. III-B1. Deviations: the text asks for every blocker of the bin to be nearer, Fig. 4
/// for the nearest one: we follow the figure, which rather keeps a point. Nor does an empty bin count as free space. On
/// a surface seen at a slant, the nearest point of a bin of 2 deg hides most of the rest: such changes are missed, as
/// they are in the paper.
[[nodiscard]] std::vector<Evidence> classify_occlusion(std::span<const Eigen::Vector3f> queries_in_camera,
                                                       std::span<const Eigen::Vector3f> blockers_in_camera,
                                                       const SphericalBins& bins, double margin_m, int num_threads = 1);

}  // namespace resight
