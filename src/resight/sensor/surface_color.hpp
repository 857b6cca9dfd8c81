// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "resight/core/image.hpp"
#include "resight/geometry/camera.hpp"

namespace resight {

/// Standard deviation of the noise of single pixels, in grey levels: from the median response of all channels to the
/// operator of Immerkaer (1996), to which slopes and most edges do not respond. 0 for an image below 3 x 3 pixels.
[[nodiscard]] double estimate_image_noise(const Image<Rgb8>& color);

/// The colour of each pixel averaged over a square around it, which is as large as it takes to bring the noise of the
/// image down to one grey level, but on the surface at depth `z_m` (camera frame, metres) no wider than `width_m`.
/// Empty for an image with less noise: there is nothing to average. Pixels without depth keep their colour. All images
/// must have the size of the camera's, or std::invalid_argument. Same bits for any number of threads.
[[nodiscard]] Image<Rgb8> average_over_surface(const Image<Rgb8>& color, const Camera& camera, const Image<float>& z_m,
                                               double width_m, int num_threads = 1);

}  // namespace resight
