// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <numbers>

#include "resight/core/options.hpp"
#include "resight/geometry/point_cloud.hpp"
#include "resight/geometry/symmetry.hpp"

namespace resight {

/// Criteria for a motion to count as a symmetry. All values are ours.
struct SymmetryOptions {
  double min_agreement = 0.97;
  double min_close_agreement = 0.85;
  double max_distance_m = 0.0015;
  double max_distance_share = 0.015;
  double max_normal_angle_rad = 0.7;
  double blur_share = 0.04;
  double max_brightness_difference = 0.2;
  double max_chroma_difference = 0.08;
  int num_samples = 800;
  int num_threads = 1;  ///< Same bits for any value >= 1.
  void check() const { check_options("SymmetryOptions", *this); }
};

inline void declare(OptionVisitor& v, SymmetryOptions& o) {
  v.field("min_agreement", o.min_agreement, between(0.5, 1),
          "Share of the surface that a symmetry motion must move onto the surface, with similar colour.");
  v.field("min_close_agreement", o.min_close_agreement, between(0, 1),
          "Share of it whose colours differ by at most half of the limits: faint texture.");
  v.field("max_distance_m", o.max_distance_m, positive(), "Largest distance from the surface, along its normal.");
  v.field("max_distance_share", o.max_distance_share, between(0, 0.1),
          "The same as a share of the diameter; the larger of both counts.");
  v.field("max_normal_angle_rad", o.max_normal_angle_rad, between(0, std::numbers::pi / 2),
          "Largest angle between the normals (40 deg: those of voxels at an edge are mixed).");
  v.field("blur_share", o.blur_share, between(0, 0.5),
          "Colours are means within this share of the diameter (and two voxels).");
  v.field("max_brightness_difference", o.max_brightness_difference, positive(),
          "Largest difference of mean Y' in [0, 1]. Wide, as scans include the light of their day.");
  v.field("max_chroma_difference", o.max_chroma_difference, positive(),
          "Largest difference of mean (Cb, Cr), each in [-0.5, 0.5].");
  v.field("num_samples", o.num_samples, between(100, 100000), "Points that are moved, evenly spread over the surface.");
  v.num_threads(o.num_threads);
}

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
