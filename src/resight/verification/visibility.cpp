// SPDX-License-Identifier: Apache-2.0
#include "resight/verification/visibility.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "resight/core/parallel.hpp"

namespace resight {
namespace {

constexpr int kMinFillNeighbors = 5;
constexpr float kMinDepth_m = 1e-3F;
constexpr int kMaxBufferCells = 1 << 20;

// A model point in a view.
struct Projected {
  float u = 0;
  float v = 0;
  float z = -1;      // Behind the camera unless set.
  float facing = 1;  // Cosine between normal and viewing ray.
};

// Nearest z of the model per cell of an image region. A cell is about as wide as the spacing of the model's points, so
// that a closed surface has no holes.
class SelfOcclusion {
 public:
  SelfOcclusion(const std::vector<Projected>& points, float focal_px, float resolution_m)
      : resolution_m_(resolution_m) {
    float min_z = std::numeric_limits<float>::infinity();
    for (const Projected& p : points)
      if (p.z > kMinDepth_m) {
        min_z = std::min(min_z, p.z);
        min_u_ = std::min(min_u_, p.u);
        min_v_ = std::min(min_v_, p.v);
        max_u_ = std::max(max_u_, p.u);
        max_v_ = std::max(max_v_, p.v);
      }
    if (!(min_z < std::numeric_limits<float>::infinity())) return;
    float cell_px = std::max(1.0F, 1.5F * resolution_m * focal_px / min_z);
    const float area = (max_u_ - min_u_ + 1) * (max_v_ - min_v_ + 1);
    cell_px = std::max(cell_px, std::sqrt(area / kMaxBufferCells));
    inverse_cell_ = 1 / cell_px;
    cell_per_depth_ = cell_px / focal_px;
    width_ = cell(max_u_ - min_u_) + 1;
    nearest_.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(cell(max_v_ - min_v_) + 1),
                    std::numeric_limits<float>::infinity());
    for (const Projected& p : points)
      if (p.z > kMinDepth_m) nearest_[index(p)] = std::min(nearest_[index(p)], p.z);
  }

  // A slanted surface changes its depth within a cell by cell * tan(angle): that much is no occlusion.
  [[nodiscard]] bool hides(const Projected& p) const {
    const float cosine = std::max(p.facing, 0.05F);
    const float slope = std::sqrt(std::max(0.0F, 1 - cosine * cosine)) / cosine;
    return p.z > nearest_[index(p)] + resolution_m_ + 1.5F * cell_per_depth_ * p.z * slope;
  }

 private:
  [[nodiscard]] int cell(float px) const { return static_cast<int>(px * inverse_cell_); }
  [[nodiscard]] std::size_t index(const Projected& p) const {
    return static_cast<std::size_t>(cell(p.v - min_v_)) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(cell(p.u - min_u_));
  }

  float resolution_m_;
  float inverse_cell_ = 1;
  float cell_per_depth_ = 0;
  float min_u_ = std::numeric_limits<float>::infinity();
  float min_v_ = std::numeric_limits<float>::infinity();
  float max_u_ = -std::numeric_limits<float>::infinity();
  float max_v_ = -std::numeric_limits<float>::infinity();
  int width_ = 0;
  std::vector<float> nearest_;
};

void project_model(std::span<const Eigen::Vector3f> points, std::span<const Eigen::Vector3f> normals,
                   const DepthView& view, std::vector<Projected>& projected) {
  const Rigid3f camera_from_world(view.world_from_camera.inverse());
  const float fx = static_cast<float>(view.camera.fx);
  const float fy = static_cast<float>(view.camera.fy);
  const float cx = static_cast<float>(view.camera.cx);
  const float cy = static_cast<float>(view.camera.cy);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3f p = camera_from_world * points[i];
    Projected& out = projected[i];
    out = {};
    if (!(p.z() > kMinDepth_m)) continue;
    out.z = p.z();
    out.u = fx * p.x() / p.z() + cx;
    out.v = fy * p.y() / p.z() + cy;
    if (!normals.empty()) out.facing = -(camera_from_world.rotation * normals[i]).dot(p) / p.norm();
  }
}

Sight look_at(const Projected& p, const DepthView& view, const SelfOcclusion& self, float margin, float min_facing) {
  if (!(p.z > kMinDepth_m) || p.facing < min_facing) return Sight::kHidden;
  if (!view.camera.contains({p.u, p.v})) return Sight::kHidden;
  const int u = std::min(static_cast<int>(std::floor(p.u + 0.5F)), view.camera.width - 1);  // The sum may round up.
  const int v = std::min(static_cast<int>(std::floor(p.v + 0.5F)), view.camera.height - 1);
  const float depth = view.depth_m(u, v);
  if (std::isnan(depth) || p.z - depth > margin || self.hides(p)) return Sight::kHidden;
  return depth - p.z > margin ? Sight::kSeenThrough : Sight::kConsistent;
}

float median_of_neighbors(const Image<float>& depth, int u, int v) {
  std::array<float, 8> values;
  int count = 0;
  for (int dv = -1; dv <= 1; ++dv)
    for (int du = -1; du <= 1; ++du)
      if (depth.contains(u + du, v + dv) && !std::isnan(depth(u + du, v + dv))) values[count++] = depth(u + du, v + dv);
  if (count < kMinFillNeighbors) return std::numeric_limits<float>::quiet_NaN();
  std::nth_element(values.begin(), values.begin() + count / 2, values.begin() + count);
  return values[count / 2];
}

// Whether a view looks through most of what it could see of the model.
bool looks_through(std::span<const Sight> sight, double min_share, int min_points) {
  const auto through = std::ranges::count(sight, Sight::kSeenThrough);
  const auto seen = through + std::ranges::count(sight, Sight::kConsistent);
  return seen >= min_points && static_cast<double>(through) > min_share * static_cast<double>(seen);
}

// What the views see of each model point, from the newest view back.
struct Seen {
  explicit Seen(std::size_t num_points)
      : best_facing(num_points, -1), num_views(num_points, 0), num_through(num_points, 0), newest(num_points) {}

  void add(std::span<const Sight> sight, std::span<const Projected> projected) {
    for (std::size_t i = 0; i < sight.size(); ++i) {
      if (sight[i] == Sight::kHidden) continue;
      if (num_views[i]++ == 0) newest[i] = sight[i];
      num_through[i] += sight[i] == Sight::kSeenThrough ? 1 : 0;
      best_facing[i] = std::max(best_facing[i], projected[i].facing);
    }
  }
  // Most of what was seen of it so far, and enough of it.
  [[nodiscard]] bool is_there(double arrival_share, int min_points) const {
    return std::ranges::count(newest, Sight::kConsistent) >= std::max(1, min_points) &&
           !looks_through(newest, arrival_share, min_points);
  }

  std::vector<float> best_facing;
  std::vector<int> num_views;
  std::vector<int> num_through;
  std::vector<Sight> newest;  // Of the newest view that sees it.
};

}  // namespace

Image<float> fill_small_holes(const Image<float>& depth_m) {
  Image<float> filled = depth_m;
  for (int v = 0; v < depth_m.height(); ++v)
    for (int u = 0; u < depth_m.width(); ++u)
      if (std::isnan(depth_m(u, v))) filled(u, v) = median_of_neighbors(depth_m, u, v);
  return filled;
}

std::vector<DepthView> prepare_depth_views(std::span<const VerificationView> views, int num_threads) {
  std::vector<DepthView> result(views.size());
  parallel_for(views.size(), num_threads, [&](std::size_t i) {
    const PreparedView& view = *views[i].view;
    const bool has_color = view.frame.color.size() == view.cloud.z.size();
    result[i] = {view.frame.camera, view.frame.world_from_camera, has_color ? &view.frame.color : nullptr,
                 fill_small_holes(view.cloud.z)};
  });
  return result;
}

ModelVisibility find_visible_points(std::span<const Eigen::Vector3f> points, std::span<const Eigen::Vector3f> normals,
                                    std::span<const DepthView> views, std::span<const std::uint8_t> allowed,
                                    const VisibilityOptions& options, const ModelSampling& sampling) {
  const float margin = static_cast<float>(options.margin_m);
  const float min_facing = static_cast<float>(kMinFacing);
  const auto* majority = std::get_if<MajorityFreeSpace>(&options.free_space);
  const int min_points = sampling.min_points;
  ModelVisibility result;
  result.sight.resize(views.size());
  std::vector<Projected> projected(points.size());
  std::vector<Sight> sight(points.size());
  Seen seen(points.size());
  for (std::size_t v = views.size(); v-- > 0;) {
    if (allowed[v] == 0) continue;
    project_model(points, normals, views[v], projected);
    const SelfOcclusion self(projected, static_cast<float>(views[v].camera.fx), static_cast<float>(sampling.spacing_m));
    for (std::size_t i = 0; i < points.size(); ++i)
      sight[i] = look_at(projected[i], views[v], self, margin, min_facing);
    if (options.arrival_share && looks_through(sight, *options.arrival_share, min_points) &&
        seen.is_there(*options.arrival_share, min_points))
      break;  // It arrived since.
    seen.add(sight, projected);
    result.sight[v] = sight;
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (seen.num_views[i] == 0) continue;
    result.visible.push_back(static_cast<int>(i));
    result.facing.push_back(seen.best_facing[i]);
    const bool through = majority != nullptr ? seen.num_through[i] > majority->max_share * seen.num_views[i]
                                             : seen.newest[i] == Sight::kSeenThrough;
    result.seen_through.push_back(through ? 1 : 0);
  }
  return result;
}

}  // namespace resight
