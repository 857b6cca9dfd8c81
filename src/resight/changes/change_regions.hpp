// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "resight/changes/change_detector.hpp"
#include "resight/geometry/oriented_box.hpp"
#include "resight/sensor/rgbd_frame.hpp"

namespace resight {

enum class RegionKind { kNovel, kRemoved };
[[nodiscard]] const char* to_string(RegionKind kind);

/// Connected surface that came or left between two views: as a rule, one thing.
struct ChangeRegion {
  RegionKind kind = RegionKind::kNovel;
  PointCloud surface_in_world;  ///< One point per voxel of DetectChangesOptions::voxel_m.
  std::vector<int> pixels;      ///< Of the view, ascending: those of the mask that show the region, or see through it.
  OrientedBox box;
};

/// Groups changed points of a view (at its corrected pose) into regions: points are connected if they are at most
/// four voxels apart, or two pixels or three standard deviations of the depth, if these are larger. Holes in the depth
/// and occluding things therefore do not part a region, as they would in the image. A region that touches one of ten
/// times as many points in the image is a fragment at its depth edges, and is joined to it. Novel regions first; each
/// kind from the largest number of points to the smallest. `voxel_m` as in DetectChangesOptions.
[[nodiscard]] std::vector<ChangeRegion> find_change_regions(const RgbdFrame& frame, const ChangeResult& changes,
                                                            double voxel_m);

}  // namespace resight
