// SPDX-License-Identifier: Apache-2.0
#include "resight/verification/surface_blur.hpp"

#include "resight/appearance/pattern_similarity.hpp"
#include "resight/core/check.hpp"
#include "resight/geometry/kd_tree.hpp"
#include "resight/verification/surface_cells.hpp"

namespace resight {
namespace {

constexpr double kSurroundings = 3;  // Their radius, in radii of the blur.

}  // namespace

SurfaceBlur::SurfaceBlur(std::span<const Eigen::Vector3f> points, double radius_m) : begin_{0} {
  const KdTree tree(points);
  std::vector<PointNeighbor> near;
  for (const Eigen::Vector3f& p : points) {
    tree.within(p, radius_m, near);
    for (const PointNeighbor& n : near) neighbors_.push_back(n.index);
    begin_.push_back(static_cast<int>(neighbors_.size()));
  }
}

std::vector<LabColor> SurfaceBlur::operator()(std::span<const LabColor> colors) const {
  require(colors.size() + 1 == begin_.size(), "SurfaceBlur: not one colour per point");
  std::vector<LabColor> blurred(colors.size());
  for (std::size_t i = 0; i < colors.size(); ++i) {
    LabColor sum;
    for (int k = begin_[i]; k < begin_[i + 1]; ++k) {
      const LabColor& c = colors[static_cast<std::size_t>(neighbors_[static_cast<std::size_t>(k)])];
      sum = {sum.l + c.l, sum.a + c.a, sum.b + c.b};
    }
    const auto n = static_cast<float>(begin_[i + 1] - begin_[i]);
    blurred[i] = {sum.l / n, sum.a / n, sum.b / n};
  }
  return blurred;
}

TextureMatch match_surface_texture(std::span<const Eigen::Vector3f> points, std::span<const LabColor> model,
                                   std::span<const LabColor> expected, std::span<const LabColor> seen,
                                   const AppearanceOptions& options) {
  TextureMatch match = match_texture(model, expected, seen, options);
  if (!options.pattern_radius_m || match.texture_contrast >= kMinTextureContrast) return match;
  const SurfaceBlur blur(points, *options.pattern_radius_m);
  const SurfaceCells cells(points, *options.pattern_radius_m);
  const SurfaceBlur around(cells.centers(), kSurroundings * *options.pattern_radius_m);
  const auto pattern = [&](std::span<const LabColor> colors) {
    std::vector<LabColor> result = blur(colors);
    const std::vector<LabColor> surroundings = around(cells.means(colors));
    for (std::size_t i = 0; i < result.size(); ++i) {
      const LabColor& mean = surroundings[cells.cell_of(i)];
      result[i] = {result[i].l - mean.l, result[i].a - mean.a, result[i].b - mean.b};
    }
    return result;
  };
  match.similarity = pattern_similarity(pattern(expected), pattern(seen), options.chroma_weight);
  return match;
}

}  // namespace resight
