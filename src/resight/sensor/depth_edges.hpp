// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>

#include "resight/core/image.hpp"
#include "resight/core/options.hpp"

namespace resight {

struct DepthEdgeOptions {
  double max_depth_jump = 0.05;
  int max_gap_px = 2;
  double max_distance_px = 5.0;
  void check() const { check_options("DepthEdgeOptions", *this); }
};

inline void declare(OptionVisitor& v, DepthEdgeOptions& o) {
  v.field("max_depth_jump", o.max_depth_jump, positive(),
          "Neighbouring pixels whose depths differ by more than this share of z are a depth edge.", "V4R");
  v.field("max_gap_px", o.max_gap_px, between(0, 1000),
          "Up to as many missing pixels in a row between similar depths are a gap in a surface and no edge. 0: every "
          "missing pixel is at an edge.");
  v.field("max_distance_px", o.max_distance_px, positive(), "Distances to the nearest edge are capped here.", "V4R");
}

/// Marks pixels at depth discontinuities with 1: pixels whose depth differs from that of one of their 8 neighbours by
/// more than the limit (a share of the smaller depth), and pixels at a border to missing depth. Marks both sides of a
/// step. The image border is not an edge. NaN pixels are 0. Gaps are bridged: if a short run of missing pixels, in one
/// of the 4 directions, connects two depths within the limit, its pixels take their mean.
[[nodiscard]] Image<std::uint8_t> find_depth_edges(const Image<float>& depth_m, const DepthEdgeOptions& options = {});

/// Euclidean distance of each pixel to the nearest edge pixel in pixels, capped at max_distance_px.
[[nodiscard]] Image<float> find_edge_distance(const Image<std::uint8_t>& edges, double max_distance_px);

/// Updates `edge_distance_px`, computed from a depth image by the functions above, after the depth of some pixels
/// changed. Gives the same result as a new computation, but processes only the affected parts of the image. Throws
/// std::invalid_argument if the images differ in size.
void update_edge_distance(const Image<float>& depth_m, std::span<const int> changed_pixels,
                          const DepthEdgeOptions& options, Image<float>& edge_distance_px);

}  // namespace resight
