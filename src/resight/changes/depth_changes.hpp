// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "resight/core/options.hpp"
#include "resight/evidence/view_comparison.hpp"

namespace resight {

/// The statistical test of changes: depth against depth.
struct DepthTestOptions {
  double sigmas = 2.5;
  std::optional<double> recolored_sigmas = 1.5;
  int min_region_px = 40;
};

inline void declare(OptionVisitor& v, DepthTestOptions& o) {
  v.field("sigmas", o.sigmas, positive(),
          "A surface has changed if it differs from what another view measured by more than this many standard "
          "deviations, along its normal.",
          "ours; noise by Nguyen et al. 2012");
  v.field(
      "recolored_sigmas", o.recolored_sigmas, positive(),
      "Replaces `sigmas` where the colour has changed relative to its surroundings, so that thin things are found; at "
      "most `sigmas`. There, a pixel has also changed if the mean distance over a few centimetres exceeds `sigmas` "
      "of its own standard deviations, so that flat things are found. Pixels of unchanged colour count less. off: "
      "colours do not count.",
      "ours");
  v.field(
      "min_region_px", o.min_region_px, at_least(1),
      "Connected regions with fewer pixels are noise; in proportion, in images of more than 640 x 480. A pixel at its "
      "threshold counts 0, one at twice the threshold or more counts 1.",
      "ours; cluster mass of Bullmore et al. 1999");
}

/// Pixels that changed between earlier views and a view.
struct DepthChanges {
  Image<std::uint8_t> novel;                  ///< Of the view: non-zero where a surface came.
  Image<std::uint8_t> removed;                ///< Of the view: non-zero where it sees through a surface of before.
  std::vector<std::vector<int>> gone_pixels;  ///< Per earlier view: its pixels whose surface has left, ascending.
  std::array<int, 4> evidence_count{};        ///< What the view says of the pixels of earlier views, by Evidence.
  std::size_t num_explained = 0;              ///< Pixels of the view whose surface an earlier view saw, too.
};

/// Compares each pixel of the view with every earlier view, and the reverse (compare_views()).
///
/// Novel: no earlier view has the surface, and at least one saw free space there. What two newer of the earlier views
/// saw through had left, and does not count: something else was at the same place. A hole in the depth of the newest
/// earlier view, within a surface that it saw, is no free space when it fills later. Removed: the view sees through the
/// surface of an earlier view. Both need neighbours, because neighbouring errors of depth are alike: a region is noise
/// unless it is large or contradicts the other view clearly (DepthTestOptions::min_region_px). Where colours have
/// changed, too, less of a difference is enough; where they are as before, pixels count less (find_color_changes()).
/// The noise is scaled to what the two views show of it (estimate_noise_scale()). If the camera moved, the errors of
/// its poses and its lens are as large as the contours of both views show (estimate_misregistration_px()). Views must
/// not be null.
[[nodiscard]] DepthChanges find_depth_changes(const PreparedView& view,
                                              std::span<const PreparedView* const> earlier_views,
                                              const DepthTestOptions& options, int num_threads);

}  // namespace resight
