// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <vector>

#include "resight/sensor/prepared_view.hpp"

namespace resight {

/// What colours say of some pixels.
struct ColorChanges {
  std::vector<int> standing_out;  ///< Differ in another way than their surroundings.
  std::vector<int> different;     ///< Differ like their surroundings.
  std::vector<int> same;          ///< Those that look as before.
  /// Share of pixels that look like one elsewhere in the image, at least 0.1. The nearer to 1, the less it means to
  /// look as before.
  double similar_share = 1;
};

/// Which of the `candidates`, pixels of `surfaces`, have another colour than in `view` after the exposure is made
/// equal, and which of these stand out: their difference is far from its mean within a few centimetres. White balance
/// and soft shadows change that mean, too; so does a large thing, inside which nothing stands out. One limit, which
/// follows from the noise of the images, says what differs and what is far. A pixel whose difference is at most half of
/// it looks as before; between half of it and the limit, nothing is said.
///
/// `view_pixels`: the pixel of `view` that each pixel of `surfaces` projects to; -1: none, and nothing is said. The
/// most similar pixel within `radius_px` rows and columns of it counts. Nothing is said if a view has no colours. Keeps
/// the order of the candidates.
[[nodiscard]] ColorChanges find_color_changes(const PreparedView& surfaces, const PreparedView& view,
                                              const Image<int>& view_pixels, std::span<const int> candidates,
                                              int radius_px);

}  // namespace resight
