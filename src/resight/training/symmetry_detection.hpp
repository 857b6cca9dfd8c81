// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "resight/geometry/point_cloud.hpp"
#include "resight/geometry/symmetry.hpp"

namespace resight {

/// Criteria for a motion to count as a symmetry. All values are ours.
struct SymmetryOptions {
  double min_agreement = 0.97;        ///< Share of the surface that must come to lie on the surface, in like colour.
  double min_close_agreement = 0.85;  ///< Share of it whose colour differs by half of the limits at most: faint prints.
  double max_distance_m = 0.0015;     ///< Off the surface, along its normal: what a scan is good for.
  double max_distance_share = 0.015;  ///< The same as a share of the diameter; the larger of both counts.
  double max_normal_angle_rad = 0.7;  ///< Between the normals: 40 deg, as those of voxels beside an edge are mixed.
  double blur_share = 0.04;           ///< Colours are means within this share of the diameter (and two voxels).
  double max_brightness_difference =
      0.2;                              ///< Of those means: Y' in [0, 1]. Wide, as scans hold the light of their day.
  double max_chroma_difference = 0.08;  ///< Of those means: (Cb, Cr), each in [-0.5, 0.5].
  int num_samples = 800;                ///< Points that are moved, evenly spread over the surface.
  int num_threads = 1;                  ///< Same bits for any value >= 1.
  void check() const;
};

/// Finds the motions that map an object onto itself in shape and colour (in shape alone if the surface has no colours):
/// continuous axes, and rotations of orders 2 to 6, 8, 10 and 12 with all their products, so that
/// enumerate_symmetries() gives a group. A ball has two continuous axes at right angles. With a continuous axis, the
/// only other motion is a half turn perpendicular to it, if the object is the same upside down. Reflections are not
/// motions. `surface` contains evenly spaced points (metres, object frame) with normals. Missing parts of the object
/// cannot contradict a symmetry.
///
/// Each symmetry axis is a principal axis of the surface. Principal axes are tried, and a dense set of directions if
/// two or three principal moments are similar; point-to-plane ICP refines each candidate. If only the texture
/// determines an axis (two labels on a can, a ball with a pattern), the axis is the tested direction: off by up to 2.5
/// deg for a round object, and by up to 4 deg for a ball, where it may therefore be missed.
///
/// Returns no symmetries without sufficient data: fewer than 100 points, no normals, values that are not finite, or a
/// surface known from one side only (length of the mean normal above 0.35; 0 for a closed surface).
[[nodiscard]] ObjectSymmetries find_symmetries(const PointCloud& surface, const SymmetryOptions& options = {});

}  // namespace resight
