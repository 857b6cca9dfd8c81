// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "resight/features/feature_set.hpp"

namespace resight {

/// Descriptors at 8 bits a component: each row is scaled so that its largest component becomes 255. The scale need not
/// be kept, because descriptors are of unit norm. `descriptors`: n x dimension, not negative, no row all zero
/// (otherwise std::invalid_argument). What decode_descriptors() returned is encoded without loss.
[[nodiscard]] std::vector<std::uint8_t> encode_descriptors(std::span<const float> descriptors, int dimension);

/// The unit vectors along the coded rows. Rows of zeros stay zero (see has_zero_row()).
[[nodiscard]] std::vector<float> decode_descriptors(std::span<const std::uint8_t> codes, int dimension);

/// True if a row holds only zeros: no direction, the mark of a damaged file.
[[nodiscard]] bool has_zero_row(std::span<const std::uint8_t> codes, int dimension);

/// Replaces the descriptors by their decoded code, so that a set in memory equals the one read back from a file.
void quantize_descriptors(FeatureSet& features);

}  // namespace resight
