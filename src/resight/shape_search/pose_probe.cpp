// SPDX-License-Identifier: Apache-2.0
#include "resight/shape_search/pose_probe.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "resight/core/check.hpp"
#include "resight/core/parallel.hpp"
#include "resight/shape_search/oriented_points.hpp"
#include "resight/verification/light_fit.hpp"
#include "resight/verification/pattern_similarity.hpp"
#include "resight/verification/point_to_plane.hpp"

namespace resight {
namespace {

constexpr double kSpacingShare = 0.05;
constexpr double kMinSpacing_m = 0.005;
constexpr float kMinFacing = 0.25F;    // Cosine between normal and viewing ray: steeper ones are measured badly.
constexpr float kMinNormalDot = 0.5F;  // 60 deg.
constexpr float kMinDepth_m = 0.05F;
constexpr int kMinPairs = 15;

bool faces_camera(const Eigen::Vector3f& p, const Eigen::Vector3f& n) { return -n.dot(p) > kMinFacing * p.norm(); }

}  // namespace

void CountSamplesOptions::check() const {
  check_positive("CountSamplesOptions.max_samples", max_samples);
  check_not_negative("CountSamplesOptions.max_wrong", max_wrong);
  check_positive("CountSamplesOptions.tolerance_m", tolerance_m);
  check_not_negative("CountSamplesOptions.tolerance_sigmas", tolerance_sigmas);
  check_positive("CountSamplesOptions.max_chroma_difference", max_chroma_difference);
}

ProbeModel make_probe_model(const ObjectModel& model, int max_samples) {
  const double spacing_m = std::max(kMinSpacing_m, kSpacingShare * static_cast<double>(model.diameter_m));
  PointCloud samples = sample_surface(model.surface, spacing_m, max_samples);
  ProbeModel result;
  if (samples.has_colors()) result.linear_light = to_linear_light(samples.colors);
  set_white_balance(result, Eigen::Array3f::Zero());
  result.points = std::move(samples.points);
  result.normals = std::move(samples.normals);
  result.center = model.center;
  for (const Eigen::Vector3f& p : result.points)
    result.radius_m = std::max<double>(result.radius_m, (p - result.center).norm());
  return result;
}

PoseProbe::PoseProbe(const PreparedView& view, double max_depth_m, int num_threads)
    : view_(view), lab_(view.cloud.width(), view.cloud.height()) {
  parallel_for_blocks(lab_.size(), 4096, num_threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      if (view.cloud.z[i] <= static_cast<float>(max_depth_m)) lab_[i] = to_lab(view.frame.color[i]);
  });
}

int PoseProbe::pixel_of(const Eigen::Vector3f& p) const {
  if (!(p.z() > kMinDepth_m)) return -1;
  const Camera& camera = view_.frame.camera;
  const float u = static_cast<float>(camera.fx) * p.x() / p.z() + static_cast<float>(camera.cx) + 0.5F;
  const float v = static_cast<float>(camera.fy) * p.y() / p.z() + static_cast<float>(camera.cy) + 0.5F;
  if (!(u >= 0 && v >= 0 && u < static_cast<float>(camera.width) && v < static_cast<float>(camera.height))) return -1;
  return static_cast<int>(lab_.index(static_cast<int>(u), static_cast<int>(v)));
}

float PoseProbe::tolerance_at(float z_m, double tolerance_m, double sigmas) const {
  return static_cast<float>(tolerance_m + sigmas * nguyen_noise(z_m, 0, view_.frame.camera.fx).axial_m);
}

SampleCounts PoseProbe::count(const ProbeModel& model, const Rigid3f& camera_from_object,
                              const CountSamplesOptions& options) const {
  SampleCounts counts;
  const float max_chroma_sq = static_cast<float>(options.max_chroma_difference * options.max_chroma_difference);
  const float tolerance =
      tolerance_at((camera_from_object * model.center).z(), options.tolerance_m, options.tolerance_sigmas);
  for (std::size_t i = 0; i < model.points.size() && counts.facing < options.max_samples; ++i) {
    const Eigen::Vector3f p = camera_from_object * model.points[i];
    if (!faces_camera(p, camera_from_object.rotation * model.normals[i])) continue;
    ++counts.facing;
    const int pixel = pixel_of(p);
    const float depth = pixel < 0 ? -1 : view_.cloud.z[static_cast<std::size_t>(pixel)];
    if (std::isnan(depth)) continue;
    if (p.z() > depth + tolerance) {
      ++counts.hidden;
    } else if (p.z() < depth - tolerance) {
      ++counts.through;
    } else {
      ++counts.confirmed;
      if (!model.lab.empty() && chroma_difference_sq(model.lab[i], lab(pixel)) > max_chroma_sq) ++counts.off_color;
    }
    counts.gave_up = counts.through + counts.off_color > options.max_wrong + counts.facing / 4;
    if (counts.gave_up) break;
  }
  return counts;
}

Rigid3 PoseProbe::refine(const ProbeModel& model, const Rigid3& camera_from_object, int max_iterations,
                         double max_distance_m) const {
  Rigid3 pose = camera_from_object;
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    const Rigid3f motion(pose);
    const Eigen::Vector3f middle = motion * model.center;
    StepEquations equations;
    for (std::size_t i = 0; i < model.points.size(); ++i) {
      const Eigen::Vector3f p = motion * model.points[i];
      const Eigen::Vector3f n = motion.rotation * model.normals[i];
      if (!faces_camera(p, n)) continue;
      const int pixel = pixel_of(p);
      if (pixel < 0 || !view_.cloud.has_normal(static_cast<std::size_t>(pixel))) continue;
      const Eigen::Vector3f q = view_.cloud.point(static_cast<std::size_t>(pixel));
      const Eigen::Vector3f m = view_.cloud.normal(static_cast<std::size_t>(pixel));
      const float u = 1 - (q - p).squaredNorm() / static_cast<float>(max_distance_m * max_distance_m);
      if (!(u > 0) || m.dot(n) < kMinNormalDot) continue;
      equations.add((p - middle).cast<double>(), m.cast<double>(), m.dot(q - p), u * u, model.radius_m);
    }
    if (equations.num_pairs < kMinPairs || !equations.step(pose, model.center.cast<double>(), model.radius_m)) break;
  }
  return pose;
}

PoseProbe::Confirmed PoseProbe::confirm(const ProbeModel& model, const Rigid3& camera_from_object,
                                        double tolerance_m) const {
  const Rigid3f motion(camera_from_object);
  const float tolerance = tolerance_at((motion * model.center).z(), tolerance_m, 3);
  Confirmed confirmed;
  for (std::size_t i = 0; i < model.points.size(); ++i) {
    const Eigen::Vector3f p = motion * model.points[i];
    const Eigen::Vector3f n = motion.rotation * model.normals[i];
    if (!faces_camera(p, n)) continue;
    ++confirmed.facing;
    const int pixel = pixel_of(p);
    const auto at = static_cast<std::size_t>(pixel);
    const float depth = pixel < 0 ? -1 : view_.cloud.z[at];
    if (std::isnan(depth)) continue;
    if (p.z() > depth + tolerance) {
      ++confirmed.hidden;
    } else if (p.z() < depth - tolerance ||
               (view_.cloud.has_normal(at) && view_.cloud.normal(at).dot(n) < kMinNormalDot)) {
      ++confirmed.wrong;
    } else {
      confirmed.samples.push_back(static_cast<int>(i));
      confirmed.pixels.push_back(at);
      confirmed.normals.push_back(n);
      if (model.linear_light.empty()) continue;
      confirmed.model_light.push_back(model.linear_light[i]);
      confirmed.scene_light.push_back(to_linear_light(view_.frame.color[at]));
    }
  }
  return confirmed;
}

LightFit PoseProbe::light_on(const ProbeModel& model, const Rigid3& camera_from_object, double tolerance_m,
                             const LightLimits& limits) const {
  const Confirmed confirmed = confirm(model, camera_from_object, tolerance_m);
  return fit_light(confirmed.model_light, confirmed.scene_light, confirmed.normals, limits);
}

// Counts as explained only what is of like colour, too.
void PoseProbe::compare_colors(const Confirmed& confirmed, const VerifyOptions& options, PoseFit& fit) const {
  const LightFit light = fit_light(confirmed.model_light, confirmed.scene_light, confirmed.normals, options.light);
  std::vector<LabColor> seen;
  std::vector<LabColor> expected;
  fit.num_explained = 0;
  for (std::size_t k = 0; k < confirmed.samples.size(); ++k) {
    expected.push_back(to_lab(light(confirmed.model_light[k], confirmed.normals[k])));
    seen.push_back(lab_[confirmed.pixels[k]]);
    const double dl = (expected[k].l - seen[k].l) / options.color_sigma_l;
    const double da = (expected[k].a - seen[k].a) / options.color_sigma_ab;
    const double db = (expected[k].b - seen[k].b) / options.color_sigma_ab;
    if (std::exp(-0.25 * (dl * dl + da * da + db * db)) > options.min_inlier_weight) ++fit.num_explained;
  }
  fit.pattern_similarity = pattern_similarity(expected, seen, options.color_sigma_l / options.color_sigma_ab);
}

PoseFit PoseProbe::judge(const ProbeModel& model, const Rigid3& camera_from_object, double tolerance_m,
                         const VerifyOptions& colors) const {
  const Confirmed confirmed = confirm(model, camera_from_object, tolerance_m);
  PoseFit fit;
  if (confirmed.samples.empty()) return fit;
  fit.num_explained = static_cast<int>(confirmed.samples.size());
  if (!confirmed.model_light.empty()) compare_colors(confirmed, colors, fit);
  fit.visible_share = 1 - static_cast<double>(confirmed.hidden) / confirmed.facing;
  fit.explained_share =
      fit.num_explained / (static_cast<double>(confirmed.samples.size()) + static_cast<double>(confirmed.wrong));
  return fit;
}

void set_white_balance(ProbeModel& model, const Eigen::Array3f& white_balance) {
  model.lab.clear();
  for (const Eigen::Vector3f& color : model.linear_light)
    model.lab.push_back(to_lab((color.array() * white_balance.exp()).min(1.0F).matrix().eval()));
}

}  // namespace resight
