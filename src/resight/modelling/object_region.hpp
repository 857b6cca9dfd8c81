// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "resight/core/image.hpp"
#include "resight/geometry/rigid3.hpp"
#include "resight/sensor/prepared_view.hpp"

namespace resight {

/// Supporting plane of an object: normal . p = offset_m. The normal points up, towards the camera.
struct SupportPlane {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double offset_m = 0;
  [[nodiscard]] double height_m(const Eigen::Vector3d& p) const { return normal.dot(p) - offset_m; }
};

/// Search region of an object: an upright cylinder on its support. The user defines the frame; find_object_region()
/// returns the camera frame.
struct ObjectRegion {
  SupportPlane plane;
  Eigen::Vector3d foot = Eigen::Vector3d::Zero();  ///< Centre of the cylinder's base, on the plane.
  double radius_m = 0;
  double height_m = 0;
  [[nodiscard]] double axis_distance_m(const Eigen::Vector3d& p) const {
    const Eigen::Vector3d d = p - foot;
    return (d - plane.normal.dot(d) * plane.normal).norm();
  }
};

/// Transforms a region from frame b to frame a.
[[nodiscard]] ObjectRegion transform(const Rigid3& a_from_b, const ObjectRegion& region_in_b);

/// A turntable is a low, wide support just above another one.
struct TurntableSearchOptions {
  double max_height_m = 0.08;
  double min_share = 0.15;  ///< Least share of the circle around the object at which the turntable's top is visible.
};

/// The support must be visible around the foot of an object.
struct FootMarginOptions {
  double width_m = 0.02;
  double min_share = 0.85;  ///< Least share of the unoccluded directions in which it is visible.
};

/// All values are ours.
struct ObjectRegionOptions {
  double max_depth_m = 1.6;         ///< Farther points are background.
  double plane_distance_m = 0.006;  ///< Of a plane's points from it.
  /// How steeply the camera may look down on the plane (80 deg). A wall in front of it is at 90 deg. The camera is held
  /// upright.
  double max_pitch_rad = 1.4;
  double min_support_area_m2 = 0.004;  ///< Of what is seen of a level surface.
  double min_height_m = 0.006;         ///< Of what stands on a support.
  double max_height_m = 0.45;
  double min_object_height_m = 0.012;
  TurntableSearchOptions turntable;
  double max_jump_m = 0.06;  ///< Between neighbouring points of one object: parts of it may overhang.
  int min_pixels = 300;      ///< Of the object.
  FootMarginOptions margin;
  /// Objects on two supports are the same if their distances to the middle differ by less.
  double same_place_px = 60;
  double max_support_shift_m = 0.10;  ///< Of the support from the one of the view before, where there is one.
  int num_hypotheses = 300;           ///< Of the random search (RANSAC) for the dominant plane.
  std::uint64_t seed = 1;
  void check() const;
};

/// Finds the object nearest to the middle of the view (or to that of `previous`) and its support. Camera frame. The
/// dominant plane that the camera looks down on defines the vertical. The support is the lowest level surface that
/// carries something and continues beside its foot, or a low, wide one just above it: the turntable on a table, not the
/// lid of a box. std::nullopt if no object stands on a level surface.
[[nodiscard]] std::optional<ObjectRegion> find_object_region(const PreparedView& view,
                                                             const ObjectRegionOptions& options = {},
                                                             const ObjectRegion* previous = nullptr);

/// All values are ours.
struct SegmentObjectOptions {
  double min_height_m = 0.005;        ///< Above the support: beyond the noise of its points.
  double max_jump_m = 0.06;           ///< Between neighbouring points of one object: parts of it may overhang.
  int max_gap_px = 4;                 ///< Between neighbouring points of one object: slanted parts give no return.
  double min_component_share = 0.05;  ///< Of the largest connected part; smaller ones are no part of the object.
  void check() const;
};

/// Mask of the object of the region (camera frame), non-zero = object: connected components of points above the
/// support, within the cylinder. All zero if there are none.
[[nodiscard]] Image<std::uint8_t> segment_object(const OrganizedCloud& cloud, const ObjectRegion& region_in_camera,
                                                 const SegmentObjectOptions& options = {});

}  // namespace resight
