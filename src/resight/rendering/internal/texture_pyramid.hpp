// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <vector>

#include "resight/core/image.hpp"

namespace resight {

/// A texture and its halvings (2x2 means). Sampling is bilinear within a level and linear between levels.
class TexturePyramid {
 public:
  /// An empty texture gives an empty pyramid.
  explicit TexturePyramid(const Image<Rgb8>& texture);

  [[nodiscard]] bool empty() const { return levels_.empty(); }
  /// Colour (0..255 per channel) at `uv`, averaged over about 2^level texels; level <= 0 is the texture itself. `uv`
  /// has its origin at the top left and wraps at whole numbers, as in surface_color().
  [[nodiscard]] Eigen::Vector3f sample(const Eigen::Vector2f& uv, float level) const;

 private:
  std::vector<Image<Rgb8>> levels_;
};

}  // namespace resight
