// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <vector>

#include "resight/sensor/prepared_view.hpp"

namespace resight {

/// Which of the `candidates`, pixels of `surfaces`, have a colour that stands out from its surroundings in another way
/// than in `view`: after the exposure is made equal, the colours differ, and their difference is far from its mean
/// within a few centimetres. White balance and soft shadows change that mean, too, and are no difference; nor is the
/// inside of a large thing, which depth shows. How far is far follows from the noise of the images.
///
/// `view_pixels`: the pixel of `view` that each pixel of `surfaces` projects to; -1: none, and no change. The most
/// similar pixel within `radius_px` rows and columns of it counts. Nothing changed if a view has no colours. Keeps the
/// order of the candidates.
[[nodiscard]] std::vector<int> find_color_changes(const PreparedView& surfaces, const PreparedView& view,
                                                  const Image<int>& view_pixels, std::span<const int> candidates,
                                                  int radius_px);

}  // namespace resight
