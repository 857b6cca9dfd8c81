// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "resight/geometry/point_cloud.hpp"
#include "resight/geometry/symmetry.hpp"

namespace resight {

/// When a motion counts as a symmetry. All values are ours.
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

/// The motions that put an object back onto itself in shape and in colour (in shape alone if the surface has no
/// colours): axes of any angle, and turns of the orders 2 to 6, 8, 10 and 12 with all their products, so that
/// enumerate_symmetries() gives a group. A ball has two continuous axes at right angles. With a continuous axis the
/// only other motion listed is a half turn across it, if the object is the same upside down. Mirror images are no
/// motions. `surface`: points (metres, object frame) with normals, of about the same distance from each other; what of
/// the object it does not hold cannot speak against a symmetry.
///
/// An axis of symmetry is a principal axis of the surface: these are tried, and where two or three of them are alike a
/// dense set of directions, each moved into place by point-to-plane ICP. Where a print alone tells an axis (two labels
/// on a can, a ball with a pattern) it is the direction that was tried, 2.5 deg off at most on what is round, and up to
/// 4 deg on a ball, where it may therefore be missed.
///
/// None for what tells nothing: fewer than 100 points, no normals, values that are not finite, a surface that is known
/// from one side only (its mean normal is longer than 0.35, where that of a closed one is 0).
[[nodiscard]] ObjectSymmetries find_symmetries(const PointCloud& surface, const SymmetryOptions& options = {});

}  // namespace resight
