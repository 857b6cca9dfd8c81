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

/// Unit normals of the points of an object's whole surface. Each is that of the plane through the point's neighbours,
/// turned to the side that the point is seen from: the cloud is looked at from all around, through an image whose cells
/// hold about four points, and what lies behind others does not count. (Carrying a side on from neighbour to neighbour,
/// Hoppe et al. 1992, gets lost at the rim of a cup.) Points that are seen from nowhere, or from both sides alike, face
/// away from the centroid. Points must be finite and for the most part distinct. Where the neighbours span no plane
/// (fewer than three points, or all on a line) the normal is some unit vector.
[[nodiscard]] std::vector<Eigen::Vector3f> estimate_outward_normals(std::span<const Eigen::Vector3f> points,
                                                                    const OutwardNormalsOptions& options = {});

/// Flips all normals if they look inwards: the surface faces outwards where it reaches farthest, so the outermost
/// points of many directions vote. True if they were flipped. `normals`: as long as `points`.
bool turn_outwards(std::span<const Eigen::Vector3f> points, std::span<Eigen::Vector3f> normals);

}  // namespace resight
