// SPDX-License-Identifier: Apache-2.0
#include "resight/annotation/color_symmetry.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "resight/annotation/internal/color_difference.hpp"
#include "resight/geometry/symmetry.hpp"
#include "resight/models/shape_symmetry_motions.hpp"

namespace resight {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kCoarseStep_rad = 6 * kDegree;
constexpr std::size_t kMaxColorViews = 8;
constexpr int kMaxColorPoints = 2500;
constexpr int kMinColorPoints = 40;

/// Compares the colours of an object with some views.
class ColorScorer {
 public:
  ColorScorer(const ObjectModel& model, double surface_voxel_m, std::span<const NumberedView> views)
      : surface_(sample_surface_evenly(model, surface_voxel_m, kMaxColorPoints)) {
    const std::size_t step = (views.size() + kMaxColorViews - 1) / kMaxColorViews;
    for (std::size_t i = 0; i < views.size(); i += step) frames_.push_back(views[i].frame);
  }

  /// Mean over the views, weighted by the number of points; infinite if none shows enough.
  [[nodiscard]] double difference(const Rigid3& world_from_object) const {
    double sum = 0;
    double weight = 0;
    for (const RgbdFrame* frame : frames_) {
      const Rigid3 camera_from_object = frame->world_from_camera.inverse() * world_from_object;
      SurfaceEvidenceOptions options;
      options.min_viewing_cosine = 0.4;
      options.self_occlusion_spacing_m = surface_.spacing_m;
      const SurfaceEvidence evidence = classify_surface({surface_.cloud.points, surface_.cloud.normals},
                                                        camera_from_object, {frame->camera, frame->depth_m}, options);
      const int num_present = evidence.num(Evidence::kPresent);
      if (num_present < std::max(kMinColorPoints, evidence.num(Evidence::kSeenThrough))) continue;
      const auto one = color_difference(surface_, evidence, camera_from_object, *frame);
      if (!one) continue;
      sum += num_present * *one;
      weight += num_present;
    }
    return weight > 0 ? sum / weight : std::numeric_limits<double>::infinity();
  }

 private:
  SampledSurface surface_;
  std::vector<const RgbdFrame*> frames_;
};

/// Halves the step until it is small.
Rigid3 search_angle(const ColorScorer& scorer, const RotationAxis& axis, Rigid3 pose) {
  double best = scorer.difference(pose);
  for (double step_rad = 0.5 * kCoarseStep_rad; step_rad > 0.1 * kDegree; step_rad /= 2) {
    for (const double angle_rad : {-step_rad, step_rad}) {
      const Rigid3 rotated = pose * rotation_about(axis, angle_rad);
      const double difference = scorer.difference(rotated);
      if (!(difference < best)) continue;
      best = difference;
      pose = rotated;
      break;
    }
  }
  return pose;
}

}  // namespace

std::optional<double> color_difference(const SampledSurface& surface, const SurfaceEvidence& evidence,
                                       const Rigid3& camera_from_object, const RgbdFrame& frame) {
  if (!surface.cloud.has_colors()) return std::nullopt;
  std::vector<std::array<float, 6>> pairs;
  std::array<double, 6> sums{};
  for (std::size_t i = 0; i < evidence.points.size(); ++i) {
    if (evidence.points[i] != Evidence::kPresent) continue;
    const auto pixel = frame.camera.pixel_of(camera_from_object * surface.cloud.points[i].cast<double>());
    if (!pixel) continue;
    const Rgb8 seen = frame.color(pixel->u, pixel->v);
    const Rgb8 own = surface.cloud.colors[i];
    pairs.push_back({static_cast<float>(seen.r), static_cast<float>(seen.g), static_cast<float>(seen.b),
                     static_cast<float>(own.r), static_cast<float>(own.g), static_cast<float>(own.b)});
    for (std::size_t c = 0; c < 6; ++c) sums[c] += pairs.back()[c];
  }
  if (pairs.empty()) return std::nullopt;
  double difference = 0;
  for (const auto& pair : pairs)
    for (std::size_t c = 0; c < 3; ++c)
      difference += std::abs(pair[c] - pair[c + 3] * std::clamp((sums[c] + 1) / (sums[c + 3] + 1), 0.4, 2.0));
  return difference / (3 * 128.0 * static_cast<double>(pairs.size()));
}

Rigid3 resolve_symmetry_by_color(const ObjectModel& model, double surface_voxel_m, const Rigid3& world_from_object,
                                 std::span<const NumberedView> views, SymmetrySearch search) {
  if (model.shape_symmetries.none() || !model.surface.has_colors() || views.empty()) return world_from_object;
  const ColorScorer scorer(model, surface_voxel_m, views);
  Rigid3 best_pose = world_from_object;
  if (search == SymmetrySearch::kAll) {
    double best = scorer.difference(world_from_object);
    for (const Rigid3& motion : shape_symmetry_motions(model, kCoarseStep_rad)) {
      const double difference = scorer.difference(world_from_object * motion);
      if (!(difference < best)) continue;
      best = difference;
      best_pose = world_from_object * motion;
    }
  }
  for (const RotationAxis& axis : model.shape_symmetries.continuous) best_pose = search_angle(scorer, axis, best_pose);
  return best_pose;
}

}  // namespace resight
