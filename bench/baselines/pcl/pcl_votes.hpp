// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "pcl_peers.hpp"

namespace resight::bench::pcl_peers {

/// pcl::Hough3DGrouping of the correspondences of one object, model_xyz[i] with scene_xyz[i]; poses scene_from_object.
/// It votes with a local frame per keypoint: that of SHOT on the given surfaces, computed before timing starts
/// (descriptors include it). Correspondences without both frames are skipped.
RESIGHT_PCL_PEER Timed<std::vector<Pose>> group_by_votes(Points model_xyz, Points scene_xyz,
                                                         std::span<const float> distances, Points model_surface,
                                                         Points scene_surface, float frame_radius_m, float bin_m,
                                                         int min_group_size);

}  // namespace resight::bench::pcl_peers
