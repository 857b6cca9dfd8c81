// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>

#include "resight/core/image.hpp"

namespace resight {

struct DepthEdgeOptions {
  double max_depth_jump = 0.05;  ///< Share of z; a larger step between neighbours is a discontinuity (V4R: 0.05 z).
  int max_gap_px =
      2;  ///< Missing runs up to so long between two like depths are gaps in a surface (registration leaves them).
  double max_distance_px = 5.0;  ///< Distances are capped here (V4R searches within 5 px).
  void check() const;
};

/// 1 at pixels beside a depth discontinuity: a step to one of the 8 neighbours of more than the limit (a share of the
/// nearer depth), or a border to missing depth (both sides of a step are marked; the image border is none). NaN pixels
/// are 0. A missing pixel does not count when a short run of missing pixels through it, in one of the 4 directions,
/// joins two depths within the limit: it takes their mean.
[[nodiscard]] Image<std::uint8_t> find_depth_edges(const Image<float>& depth_m, const DepthEdgeOptions& options = {});

/// Euclidean distance of every pixel to the nearest edge pixel, px, capped at max_distance_px.
[[nodiscard]] Image<float> find_edge_distance(const Image<std::uint8_t>& edges, double max_distance_px);

/// Brings `edge_distance_px`, made of a depth image by both of the above, up to date after the depth of some pixels has
/// changed: the same as making it anew, in the parts of the image that they reach.
void update_edge_distance(const Image<float>& depth_m, std::span<const int> changed_pixels,
                          const DepthEdgeOptions& options, Image<float>& edge_distance_px);

}  // namespace resight
