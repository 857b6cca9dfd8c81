// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "resight/core/image.hpp"

namespace resight {

/// The depth (NaN: no return) with each missing pixel that has at least five of its eight neighbours replaced by their
/// median. Larger holes stay: where nothing was measured, or was cleared as removed, there is no evidence.
[[nodiscard]] Image<float> fill_small_holes(const Image<float>& depth_m);

}  // namespace resight
