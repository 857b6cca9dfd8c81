// SPDX-License-Identifier: Apache-2.0
#include "resight/shape_search/pose_probe.hpp"

#include <algorithm>
#include <cmath>

#include "resight/core/parallel.hpp"
#include "resight/verification/pattern_similarity.hpp"
#include "resight/verification/point_to_plane.hpp"

namespace resight {
namespace {

constexpr float kMinFacing = 0.25F;  // Cosine between normal and viewing ray.
constexpr float kMinNormalDot = 0.6F;
constexpr int kMinPairs = 15;

bool faces_camera(const Eigen::Vector3f& p, const Eigen::Vector3f& n) { return -n.dot(p) > kMinFacing * p.norm(); }

}  // namespace

PoseProbe::PoseProbe(const PreparedView& view, double max_depth_m, int num_threads)
    : view_(view), lab_(view.cloud.width(), view.cloud.height()) {
  parallel_for_blocks(lab_.size(), 4096, num_threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      if (view.cloud.z[i] <= static_cast<float>(max_depth_m)) lab_[i] = to_lab(view.frame.color[i]);
  });
}

int PoseProbe::pixel_of(const Eigen::Vector3f& p) const {
  if (!(p.z() > 0.05F)) return -1;
  const Camera& camera = view_.frame.camera;
  const int u = static_cast<int>(std::floor(static_cast<float>(camera.fx) * p.x() / p.z() +
                                            static_cast<float>(camera.cx) + 0.5F));
  const int v = static_cast<int>(std::floor(static_cast<float>(camera.fy) * p.y() / p.z() +
                                            static_cast<float>(camera.cy) + 0.5F));
  return view_.cloud.z.contains(u, v) ? static_cast<int>(view_.cloud.z.index(u, v)) : -1;
}

ProbeCounts PoseProbe::count(const ProbeModel& model, const Rigid3f& camera_from_object, int max_samples, int max_wrong,
                             const ProbeOptions& options) const {
  ProbeCounts counts;
  const float max_chroma_sq = static_cast<float>(options.max_chroma_difference * options.max_chroma_difference);
  for (std::size_t i = 0; i < model.points.size() && counts.facing < max_samples; ++i) {
    const Eigen::Vector3f p = camera_from_object * model.points[i];
    if (!faces_camera(p, camera_from_object.rotation * model.normals[i])) continue;
    ++counts.facing;
    const int pixel = pixel_of(p);
    if (pixel < 0) {
      ++counts.hidden;
      continue;
    }
    const auto at = static_cast<std::size_t>(pixel);
    const float depth = view_.cloud.z[at];
    if (std::isnan(depth)) continue;
    const float tolerance = static_cast<float>(options.tolerance_m) +
                            static_cast<float>(options.tolerance_sigmas) * 0.0019F * (p.z() - 0.4F) * (p.z() - 0.4F);
    if (p.z() > depth + tolerance) {
      ++counts.hidden;
    } else if (p.z() < depth - tolerance) {
      ++counts.through;
    } else {
      ++counts.confirmed;
      if (!model.lab.empty()) {
        const float da = model.lab[i].a - lab_[at].a;
        const float db = model.lab[i].b - lab_[at].b;
        if (da * da + db * db > max_chroma_sq) ++counts.off_color;
      }
    }
    if (counts.through + counts.off_color > max_wrong + counts.facing / 4) break;
  }
  return counts;
}

Rigid3 PoseProbe::refine(const ProbeModel& model, const Rigid3& camera_from_object, int iterations,
                         double max_distance_m) const {
  Rigid3 pose = camera_from_object;
  double radius_m = 1e-3;
  for (const Eigen::Vector3f& p : model.points) radius_m = std::max<double>(radius_m, (p - model.center).norm());
  for (int iteration = 0; iteration < iterations; ++iteration) {
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
      const float distance_sq = (q - p).squaredNorm();
      const float u = 1 - distance_sq / static_cast<float>(max_distance_m * max_distance_m);
      if (u <= 0 || m.dot(n) < kMinNormalDot) continue;
      equations.add((p - middle).cast<double>(), m.cast<double>(), m.dot(q - p), u * u, radius_m);
    }
    if (equations.num_pairs < kMinPairs) break;
    if (!equations.step(pose, model.center.cast<double>(), radius_m)) break;
  }
  return pose;
}

PoseProbe::Fit PoseProbe::judge(const ProbeModel& model, const Rigid3f& camera_from_object, double tolerance_m,
                                double sigma_l, double sigma_ab, const LightLimits& limits) const {
  std::vector<int> confirmed;  // Samples, and beside them their pixels.
  std::vector<std::size_t> pixels;
  std::vector<Eigen::Vector3f> normals;
  int facing = 0;
  int hidden = 0;
  int wrong = 0;
  for (std::size_t i = 0; i < model.points.size(); ++i) {
    const Eigen::Vector3f p = camera_from_object * model.points[i];
    const Eigen::Vector3f n = camera_from_object.rotation * model.normals[i];
    if (!faces_camera(p, n)) continue;
    ++facing;
    const int pixel = pixel_of(p);
    if (pixel < 0) {
      ++hidden;
      continue;
    }
    const auto at = static_cast<std::size_t>(pixel);
    const float depth = view_.cloud.z[at];
    if (std::isnan(depth)) continue;
    const float tolerance = static_cast<float>(tolerance_m) + 3 * 0.0019F * (p.z() - 0.4F) * (p.z() - 0.4F);
    if (p.z() > depth + tolerance) {
      ++hidden;
      continue;
    }
    if (p.z() < depth - tolerance ||
        (view_.cloud.has_normal(at) && view_.cloud.normal(at).dot(n) < 0.5F)) {
      ++wrong;
      continue;
    }
    confirmed.push_back(static_cast<int>(i));
    pixels.push_back(at);
    normals.push_back(n);
  }
  Fit fit;
  if (facing == 0) return fit;
  fit.visible_share = 1 - static_cast<double>(hidden) / facing;
  double explained = static_cast<double>(confirmed.size());
  if (!model.lab.empty()) {
    std::vector<Eigen::Vector3f> model_light;
    std::vector<Eigen::Vector3f> scene_light;
    for (std::size_t k = 0; k < confirmed.size(); ++k) {
      model_light.push_back(model.linear_light[static_cast<std::size_t>(confirmed[k])]);
      scene_light.push_back(to_linear_light(view_.frame.color[pixels[k]]));
    }
    const LightFit light = fit_light(model_light, scene_light, normals, limits);
    std::vector<LabColor> model_lab;
    std::vector<LabColor> scene_lab;
    explained = 0;
    for (std::size_t k = 0; k < confirmed.size(); ++k) {
      model_lab.push_back(to_lab(light(model_light[k], normals[k])));
      scene_lab.push_back(lab_[pixels[k]]);
      const float dl = model_lab[k].l - scene_lab[k].l;
      const float da = model_lab[k].a - scene_lab[k].a;
      const float db = model_lab[k].b - scene_lab[k].b;
      explained += std::exp(-0.25 * (dl * dl / (sigma_l * sigma_l) + (da * da + db * db) / (sigma_ab * sigma_ab))) > 0.8
                       ? 1
                       : 0;
    }
    fit.pattern_similarity = pattern_similarity(model_lab, scene_lab, sigma_l / sigma_ab);
  }
  fit.num_explained = static_cast<int>(explained);
  const double visible = static_cast<double>(confirmed.size()) + wrong;
  fit.explained_share = visible > 0 ? explained / visible : 0;
  return fit;
}

}  // namespace resight
