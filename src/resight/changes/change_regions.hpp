// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "resight/changes/change_detector.hpp"
#include "resight/sensor/rgbd_frame.hpp"

namespace resight {

enum class RegionKind { kNovel, kRemoved };
[[nodiscard]] const char* to_string(RegionKind kind);

/// A box around points, along their principal axes. Its x axis is the longest side, its z axis the shortest.
struct OrientedBox {
  Rigid3 world_from_box;                             ///< The origin is the centre of the box.
  Eigen::Vector3d size_m = Eigen::Vector3d::Zero();  ///< Length of the sides.
};

/// Connected surface that came or left between two views: as a rule, one thing.
struct ChangeRegion {
  RegionKind kind = RegionKind::kNovel;
  PointCloud surface_in_world;  ///< One point per voxel of DetectChangesOptions::voxel_m.
  std::vector<int> pixels;      ///< Of the view, ascending: those of the mask that show the region, or see through it.
  OrientedBox box;
};

/// The smallest box with the axes of a principal component analysis. The cloud must not be empty.
[[nodiscard]] OrientedBox fit_box(const PointCloud& cloud_in_world);

/// Groups changed points of a view (at its corrected pose) into regions: points are connected if they are at most
/// four voxels apart. Holes in the depth and occluding things therefore do not part a region, as they would in the
/// image. Novel regions first; each kind from the largest number of points to the smallest. `voxel_m` as in
/// DetectChangesOptions.
[[nodiscard]] std::vector<ChangeRegion> find_change_regions(const RgbdFrame& frame, const ChangeResult& changes,
                                                            double voxel_m);

}  // namespace resight
