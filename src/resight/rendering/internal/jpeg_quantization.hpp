// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>

#include "resight/core/image.hpp"

namespace resight {

/// Replaces an RGB image (0..255) by what baseline JPEG keeps of it: chroma at half resolution, and cosine coefficients
/// of blocks of 8 x 8 rounded to multiples of the tables of ITU-T T.81, Annex K, scaled as libjpeg does for `quality`.
void quantize_as_jpeg(Image<Eigen::Vector3f>& rgb, int quality, int num_threads);

}  // namespace resight
