// SPDX-License-Identifier: Apache-2.0
#include "resight/segmentation/noisy_planes.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "resight/core/check.hpp"
#include "resight/core/random.hpp"
#include "resight/core/statistics.hpp"
#include "resight/segmentation/internal/fit_plane.hpp"

namespace resight {
namespace {

constexpr int kMaxPlanes = 4;            // Floor and walls.
constexpr std::size_t kMinPoints = 300;  // Of a plane.
constexpr int kTriples = 200;            // A plane of a third of the points is missed once in 2,000 times.
constexpr std::uint32_t kScored = 1000;  // Points that the triples are drawn from and scored by.
constexpr float kScoringSigmas = 6;      // Within this, in modelled sigmas, a point supports a triple: the scale is not
                                         // known yet.
constexpr int kNoisyRefits = 4;
constexpr float kMaxNoiseScale = 3;     // Of the residuals to the model: more is no noise.
constexpr float kSurroundings = 3;      // Points within so many tolerances of a plane are around it.
constexpr float kMinCleanShare = 0.9F;  // Of the points around a plane, on it.

class NoisyPlaneFinder {
 public:
  NoisyPlaneFinder(std::span<const Eigen::Vector3f> points, std::span<const Eigen::Vector3f> normals,
                   std::span<const float> noise_m, std::vector<int> candidates, const NoisyPlanesOptions& options)
      : points_(points),
        normals_(normals),
        noise_m_(noise_m),
        left_(std::move(candidates)),
        options_(options),
        rng_(options.seed) {}

  std::vector<ScenePlane> find() {
    std::vector<ScenePlane> planes;
    for (int i = 0; i < kMaxPlanes && left_.size() >= kMinPoints; ++i)
      if (std::optional<ScenePlane> plane = find_one()) planes.push_back(std::move(*plane));
    return planes;
  }

 private:
  // The best plane of this round; takes its points. None if it is small, or cuts through other things.
  std::optional<ScenePlane> find_one() {
    std::optional<ScenePlane> plane = best_of_triples();
    if (!plane || !refit(*plane)) return std::nullopt;
    std::vector<int> on = on_plane(*plane);
    if (on.size() < kMinPoints) return std::nullopt;
    set_outline(*plane, points_, on);
    plane->num_points = static_cast<int>(on.size());
    if (plane->extent_m < options_.min_extent_m || !is_clean(*plane, on.size())) return std::nullopt;
    std::erase_if(left_, [&](int i) { return is_on(*plane, i); });
    return plane;
  }

  std::optional<ScenePlane> best_of_triples() {
    std::vector<int> scored(kScored);
    for (int& i : scored) i = left_[rng_.below(static_cast<std::uint32_t>(left_.size()))];
    std::optional<ScenePlane> best;
    std::ptrdiff_t best_count = 0;
    for (int t = 0; t < kTriples; ++t) {
      // One after the other: the order of evaluation of arguments is that of the compiler.
      const int c = scored[rng_.below(kScored)];
      const int b = scored[rng_.below(kScored)];
      const int a = scored[rng_.below(kScored)];
      const auto plane = through(a, b, c);
      if (!plane) continue;
      const auto count = std::ranges::count_if(scored, [&](int i) { return is_on(*plane, i); });
      if (count <= best_count) continue;
      best_count = count;
      best = plane;
    }
    return best;
  }

  // Facing the side of the normals, which all must agree.
  [[nodiscard]] std::optional<ScenePlane> through(int a, int b, int c) const {
    constexpr float kMinArea_m2 = 1e-4F;  // Of the parallelogram: three points in a row determine no plane.
    const Eigen::Vector3f normal = (points_[b] - points_[a]).cross(points_[c] - points_[a]);
    if (!(normal.norm() > kMinArea_m2)) return std::nullopt;
    ScenePlane plane;
    plane.normal = normal.normalized();
    if (plane.normal.dot(normals_[a]) < 0) plane.normal = -plane.normal;
    plane.offset = plane.normal.dot(points_[a]);
    plane.noise_scale = kScoringSigmas / ScenePlane::kToleranceSigmas;
    if (!faces(plane, a) || !faces(plane, b) || !faces(plane, c)) return std::nullopt;
    return plane;
  }

  // Fits to the points on it and estimates their noise, in turns.
  bool refit(ScenePlane& plane) const {
    for (int i = 0; i < kNoisyRefits; ++i) {
      const std::vector<int> on = on_plane(plane);
      if (on.size() < 3) return false;
      plane = fit_plane(points_, normals_, on);
      plane.noise_scale = std::clamp(noise_scale(plane, on), 1.0F, kMaxNoiseScale);
    }
    return true;
  }

  [[nodiscard]] float noise_scale(const ScenePlane& plane, const std::vector<int>& on) const {
    std::vector<float> residuals;
    residuals.reserve(on.size());
    for (const int i : on) residuals.push_back(std::abs(plane.signed_distance(points_[i])) / noise_m_[i]);
    return static_cast<float>(kNormalizedMad) * upper_median(std::move(residuals));
  }

  [[nodiscard]] bool is_clean(const ScenePlane& plane, std::size_t num_on) const {
    const auto around = std::ranges::count_if(left_, [&](int i) {
      return std::abs(plane.signed_distance(points_[i])) <= kSurroundings * plane.tolerance_m(noise_m_[i]) &&
             plane.covers(points_[i]);
    });
    return static_cast<float>(num_on) >= kMinCleanShare * static_cast<float>(around);
  }

  [[nodiscard]] std::vector<int> on_plane(const ScenePlane& plane) const {
    std::vector<int> on;
    for (const int i : left_)
      if (is_on(plane, i)) on.push_back(i);
    return on;
  }
  [[nodiscard]] bool is_on(const ScenePlane& plane, int i) const {
    return std::abs(plane.signed_distance(points_[i])) <= plane.tolerance_m(noise_m_[i]) && faces(plane, i);
  }
  [[nodiscard]] bool faces(const ScenePlane& plane, int i) const {
    return plane.normal.dot(normals_[i]) >= ScenePlane::kMinNoisyDot;
  }

  std::span<const Eigen::Vector3f> points_;
  std::span<const Eigen::Vector3f> normals_;
  std::span<const float> noise_m_;
  std::vector<int> left_;
  NoisyPlanesOptions options_;
  Rng rng_;
};

}  // namespace

std::vector<ScenePlane> find_noisy_planes(std::span<const Eigen::Vector3f> points,
                                          std::span<const Eigen::Vector3f> normals, std::span<const float> noise_m,
                                          std::vector<int> candidates, const NoisyPlanesOptions& options) {
  require(normals.size() == points.size() && noise_m.size() == points.size(),
          "find_noisy_planes: normals or noise of other points");
  return NoisyPlaneFinder(points, normals, noise_m, std::move(candidates), options).find();
}

}  // namespace resight
