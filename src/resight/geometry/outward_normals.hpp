// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

namespace resight {

struct OutwardNormalsOptions {
  int num_neighbors = 16;   ///< Of each point, for its plane.
  int num_directions = 96;  ///< That the cloud is looked at from, to tell its outside.
  int num_threads = 1;      ///< Same bits for any value >= 1.
  void check() const;
};

/// Estimates outward unit normals of the points on the whole surface of an object. The axis of each normal is that of
/// the plane through the neighbours of the point. The sign is that of the side from which the point is visible: the
/// cloud is rendered from `num_directions` directions into images with about four points per cell, and hidden points do
/// not count. (Propagating the sign from neighbour to neighbour, Hoppe et al. 1992, fails at the rim of a cup.) Points
/// that are visible from no side, or from both sides alike, face away from the centroid. Points must be finite and
/// mostly distinct. If the neighbours span no plane (fewer than three points, or all on a line), the normal is an
/// arbitrary unit vector.
[[nodiscard]] std::vector<Eigen::Vector3f> estimate_outward_normals(std::span<const Eigen::Vector3f> points,
                                                                    const OutwardNormalsOptions& options = {});

/// Flips all normals if most outermost points face inwards. A surface faces outwards at its extremes, so the outermost
/// points of many directions vote. Returns whether the normals were flipped. `normals` must be as long as `points`.
bool turn_outwards(std::span<const Eigen::Vector3f> points, std::span<Eigen::Vector3f> normals);

}  // namespace resight
