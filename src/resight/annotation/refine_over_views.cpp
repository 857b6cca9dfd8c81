// SPDX-License-Identifier: Apache-2.0
#include "resight/annotation/refine_over_views.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "resight/annotation/internal/sampled_surface.hpp"
#include "resight/core/check.hpp"
#include "resight/core/statistics.hpp"
#include "resight/evidence/surface_evidence.hpp"
#include "resight/registration/point_to_plane.hpp"
#include "resight/sensor/noise_model.hpp"

namespace resight {
namespace {

constexpr int kMinVisible = 25;        // Points that tell whether an object is there.
constexpr double kMaxGoneShare = 0.6;  // As in the object history.
constexpr double kMinCosine = 0.3;
constexpr int kMinPairs = 30;
constexpr double kNarrowGate = 0.35;      // Of the largest gate, for the second fit.
constexpr double kCloseMargin_m = 0.003;  // Of points that count for a pose.
constexpr double kMinInformation = 0.01;  // Of a direction, over the mean.
constexpr double kShrink = 0.75;          // Of the gate, per iteration.

/// The surface at a pose in one view, and the depth of that view.
struct PosedView {
  const RgbdFrame& frame;
  Rigid3 camera_from_object;
  SurfaceEvidence evidence;
};

PosedView classify(const SampledSurface& surface, const Rigid3& world_from_object, const RgbdFrame& frame,
                   const DepthMargin& margin) {
  PosedView posed{frame, frame.world_from_camera.inverse() * world_from_object, {}};
  SurfaceEvidenceOptions options;
  options.margin = margin;
  options.min_viewing_cosine = kMinCosine;
  options.self_occlusion_spacing_m = surface.spacing_m;
  posed.evidence = classify_surface({surface.cloud.points, surface.cloud.normals}, posed.camera_from_object,
                                    {frame.camera, frame.depth_m}, options);
  return posed;
}

/// Distance from a surface point to the measurement of its pixel, along the normal of the point.
struct PlanePair {
  Eigen::Vector3f normal_in_camera;
  float distance_m = 0;
  float depth_m = 0;
};

/// None where rounding leads to a neighbouring pixel without depth.
std::optional<PlanePair> measure_pair(const PosedView& view, const Rigid3f& to_camera, const SampledSurface& surface,
                                      std::size_t i) {
  const Eigen::Vector3f p = to_camera * surface.cloud.points[i];
  const auto pixel = view.frame.camera.pixel_of(p.cast<double>());
  if (!pixel || std::isnan(view.frame.depth_m(pixel->u, pixel->v))) return std::nullopt;
  PlanePair pair;
  pair.normal_in_camera = to_camera.rotation * surface.cloud.normals[i];
  pair.depth_m = view.frame.depth_m(pixel->u, pixel->v);
  const Eigen::Vector3f measured =
      view.frame.camera.unproject(pixel->u, pixel->v, static_cast<double>(pair.depth_m)).cast<float>();
  pair.distance_m = pair.normal_in_camera.dot(measured - p);
  return pair;
}

ViewResidual assess_view(const SampledSurface& surface, const Rigid3& world_from_object, const NumberedView& view) {
  const PosedView posed = classify(surface, world_from_object, *view.frame, DepthMargin{});
  ViewResidual residual{.view = view.number};
  const int num_present = posed.evidence.num(Evidence::kPresent);
  residual.num_visible = num_present + posed.evidence.num(Evidence::kSeenThrough);
  residual.is_informative = residual.num_visible >= kMinVisible;
  if (residual.num_visible > 0) residual.supported_share = static_cast<double>(num_present) / residual.num_visible;
  residual.is_gone = residual.is_informative && 1 - residual.supported_share > kMaxGoneShare;
  residual.is_used = residual.is_informative && !residual.is_gone;
  const Rigid3f to_camera(posed.camera_from_object);
  std::vector<float> distances_m;
  for (std::size_t i = 0; i < posed.evidence.points.size(); ++i) {
    if (posed.evidence.points[i] != Evidence::kPresent) continue;
    if (const auto pair = measure_pair(posed, to_camera, surface, i)) distances_m.push_back(std::abs(pair->distance_m));
  }
  if (!distances_m.empty()) residual.median_distance_m = static_cast<double>(upper_median(std::move(distances_m)));
  return residual;
}

/// Adds the pairs of one view to the equations, which are in the world frame.
void add_pairs(const SampledSurface& surface, const PosedView& view, const Rigid3& world_from_object, double gate_m,
               StepEquations& equations) {
  const Rigid3f to_camera(view.camera_from_object);
  const Eigen::Matrix3d& to_world = view.frame.world_from_camera.rotation;
  const double focal_px = 0.5 * (view.frame.camera.fx + view.frame.camera.fy);
  for (std::size_t i = 0; i < view.evidence.points.size(); ++i) {
    if (view.evidence.points[i] != Evidence::kPresent) continue;
    const auto pair = measure_pair(view, to_camera, surface, i);
    if (!pair) continue;
    const double weight = tukey(pair->distance_m / gate_m);
    if (weight == 0) continue;
    const double angle_rad = std::acos(std::min(1.0F, view.evidence.viewing_cosine[i]));
    const double sigma_m =
        noise_sigma(view.frame.camera.noise, pair->depth_m, angle_rad, focal_px).axial_m * std::cos(angle_rad);
    const Eigen::Vector3d arm = world_from_object.rotation * (surface.cloud.points[i].cast<double>() - surface.middle);
    equations.add(arm, to_world * pair->normal_in_camera.cast<double>(), pair->distance_m,
                  weight * 1e-6 / (sigma_m * sigma_m), surface.radius_m);
  }
}

/// Keeps directions that the pairs hardly determine, such as the rotation of a mug whose handle no view shows. They
/// would drift from step to step.
void hold_weak_directions(StepEquations& equations) {
  const Eigen::SelfAdjointEigenSolver<Matrix6> solver(equations.matrix);
  const double mean = equations.matrix.trace() / 6;
  for (int i = 0; i < 6; ++i) {
    if (solver.eigenvalues()[i] > kMinInformation * mean) continue;
    const Vector6 direction = solver.eigenvectors().col(i);
    equations.right -= direction.dot(equations.right) * direction;
    equations.matrix += mean * direction * direction.transpose();
  }
}

/// A pose and the number of its pairs.
struct FittedPose {
  Rigid3 world_from_object;
  int num_pairs = 0;
};

/// Fits from pairs within `gate_m`, which shrinks.
FittedPose fit_pose(const SampledSurface& surface, const Rigid3& world_from_object, std::span<const NumberedView> views,
                    double gate_m, const RefineOverViewsOptions& options) {
  FittedPose fitted{world_from_object, 0};
  for (int i = 0; i < options.max_iterations; ++i) {
    StepEquations equations;
    for (const NumberedView& view : views) {
      // A view decides whether the object is there by the same points that it moves.
      const PosedView posed =
          classify(surface, fitted.world_from_object, *view.frame, DepthMargin{.base_m = gate_m, .noise_sigmas = 3});
      const int num_present = posed.evidence.num(Evidence::kPresent);
      const int num_visible = num_present + posed.evidence.num(Evidence::kSeenThrough);
      if (num_visible < kMinVisible || num_present < (1 - kMaxGoneShare) * num_visible) continue;
      add_pairs(surface, posed, fitted.world_from_object, gate_m, equations);
    }
    fitted.num_pairs = equations.num_pairs;
    if (equations.num_pairs < kMinPairs) break;
    hold_weak_directions(equations);
    const double step_m = equations.step(fitted.world_from_object, surface.middle, surface.radius_m);
    const bool is_last_gate = gate_m <= options.min_distance_m;
    if (is_last_gate && step_m < 0.1 * StepEquations::kStill_m) break;
    gate_m = std::max(options.min_distance_m, kShrink * gate_m);
  }
  fitted.world_from_object.rotation = nearest_rotation(fitted.world_from_object.rotation);
  return fitted;
}

/// Points that the views support closely, less those that they see through.
int count_support(const SampledSurface& surface, const Rigid3& world_from_object, std::span<const NumberedView> views) {
  int support = 0;
  for (const NumberedView& view : views) {
    const PosedView posed =
        classify(surface, world_from_object, *view.frame, DepthMargin{.base_m = kCloseMargin_m, .noise_sigmas = 2});
    support += posed.evidence.num(Evidence::kPresent) - posed.evidence.num(Evidence::kSeenThrough);
  }
  return support;
}

}  // namespace

void RefineOverViewsOptions::check() const {
  check_positive("RefineOverViewsOptions.min_distance_m", min_distance_m);
  check_in_range("RefineOverViewsOptions.max_distance_m", max_distance_m, min_distance_m, 1);
  require(max_points > 0 && max_iterations >= 0, "RefineOverViewsOptions: max_points must be > 0, iterations >= 0");
}

std::vector<ViewResidual> assess_views(const ObjectModel& model, double surface_voxel_m,
                                       const Rigid3& world_from_object, std::span<const NumberedView> views) {
  const SampledSurface surface = sample_surface_evenly(model, surface_voxel_m, RefineOverViewsOptions{}.max_points);
  std::vector<ViewResidual> residuals;
  for (const NumberedView& view : views) residuals.push_back(assess_view(surface, world_from_object, view));
  return residuals;
}

RefinedPlacement refine_over_views(const ObjectModel& model, double surface_voxel_m, const Rigid3& world_from_object,
                                   std::span<const NumberedView> views, const RefineOverViewsOptions& options) {
  options.check();
  require(std::ranges::none_of(views, [](const NumberedView& v) { return v.frame == nullptr; }),
          "refine_over_views: a view is null");
  const SampledSurface surface = sample_surface_evenly(model, surface_voxel_m, options.max_points);
  FittedPose best{world_from_object, 0};
  // A fit that makes it clearly worse does not count.
  int best_support = static_cast<int>(0.95 * count_support(surface, world_from_object, views));
  for (const double share : {1.0, kNarrowGate}) {
    if (share < 1 && !options.fit_twice) continue;
    const FittedPose fitted = fit_pose(surface, world_from_object, views,
                                       std::max(options.min_distance_m, share * options.max_distance_m), options);
    const int support = count_support(surface, fitted.world_from_object, views);
    best.num_pairs = std::max(best.num_pairs, fitted.num_pairs);
    if (support <= best_support) continue;
    best_support = support;
    best = fitted;
  }
  RefinedPlacement refined{.world_from_object = best.world_from_object, .views = {}, .num_pairs = best.num_pairs};
  for (const NumberedView& view : views) refined.views.push_back(assess_view(surface, refined.world_from_object, view));
  return refined;
}

}  // namespace resight
