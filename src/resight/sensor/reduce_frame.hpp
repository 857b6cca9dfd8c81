// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "resight/core/image.hpp"
#include "resight/core/result.hpp"
#include "resight/sensor/rgbd_frame.hpp"
#include "resight/sensor/sequence.hpp"

namespace resight {

/// Smallest divisor of width and height with which an image has at most `max_pixels` pixels, but at least one.
[[nodiscard]] int find_reduction(const Camera& camera, int max_pixels);

/// The camera of a reduced frame.
[[nodiscard]] Camera reduce_camera(const Camera& camera, int divisor);

/// A frame with 1/divisor of the width and height. Colours are means of blocks of divisor x divisor pixels. The depth
/// of a block is the lower median of its measurements: means would lie between object and background. It is NaN if
/// fewer than half of the pixels have one. Blocks that the right and lower border cut are dropped. `divisor`: at least
/// 1, at most width and height (else std::invalid_argument).
[[nodiscard]] RgbdFrame reduce_frame(const RgbdFrame& frame, int divisor);

/// A mask of a reduced frame in the size of the recorded one, `width` x `height`. What reduce_frame() dropped is 0.
[[nodiscard]] Image<std::uint8_t> enlarge_mask(const Image<std::uint8_t>& reduced, int divisor, int width, int height);

/// Reads a view that is to be kept, reduced if it has more than `max_pixels`.
[[nodiscard]] Result<RgbdFrame> read_reduced_view(const Sequence& sequence, int view, int max_pixels);

}  // namespace resight
