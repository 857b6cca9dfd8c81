// SPDX-License-Identifier: Apache-2.0
#include "resight/verification/surface_blur.hpp"

#include "resight/appearance/pattern_similarity.hpp"
#include "resight/core/check.hpp"
#include "resight/geometry/kd_tree.hpp"
#include "resight/geometry/voxel_map.hpp"

namespace resight {
namespace {

constexpr double kSurroundings = 3;  // Their radius, in radii of the blur.

// Means over cubes of the surface, which are enough for what changes slowly.
class SurfaceCells {
 public:
  SurfaceCells(std::span<const Eigen::Vector3f> points, double side_m) {
    VoxelMap cells;
    for (const Eigen::Vector3f& p : points) {
      const auto cell = static_cast<std::size_t>(cells.insert(voxel_key(p, static_cast<float>(1 / side_m))));
      cell_of_.push_back(cell);
      if (cell == num_points_.size()) {
        num_points_.push_back(0);
        centers_.emplace_back(Eigen::Vector3f::Zero());
      }
      centers_[cell] += (p - centers_[cell]) / ++num_points_[cell];
    }
  }
  [[nodiscard]] const std::vector<Eigen::Vector3f>& centers() const { return centers_; }
  [[nodiscard]] std::size_t cell_of(std::size_t point) const { return cell_of_[point]; }
  [[nodiscard]] std::vector<LabColor> means(std::span<const LabColor> colors) const {
    std::vector<LabColor> means(centers_.size());
    for (std::size_t i = 0; i < colors.size(); ++i) {
      LabColor& mean = means[cell_of_[i]];
      const float share = 1 / num_points_[cell_of_[i]];
      mean = {mean.l + share * colors[i].l, mean.a + share * colors[i].a, mean.b + share * colors[i].b};
    }
    return means;
  }

 private:
  std::vector<std::size_t> cell_of_;
  std::vector<float> num_points_;
  std::vector<Eigen::Vector3f> centers_;
};

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
