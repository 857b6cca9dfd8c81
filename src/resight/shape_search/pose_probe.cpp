// SPDX-License-Identifier: Apache-2.0
#include "resight/shape_search/pose_probe.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "resight/core/check.hpp"
#include "resight/core/parallel.hpp"
#include "resight/shape_search/oriented_points.hpp"
#include "resight/shape_search/silhouette.hpp"
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
constexpr float kCellSpacings = 1.5F;  // Cells of a silhouette, in spacings of the samples: without holes.
constexpr float kMaxContinuationOffset_m = 0.005F;
constexpr float kMinContinuationDot = 0.9F;        // 26 deg: more is an edge.
constexpr float kMaxContinuationExponent = 0.22F;  // Colours that explain each other (0.8).
constexpr float kMinPlane_m = 0.1F;
constexpr float kPlaneDistance_m = 0.01F;
constexpr float kMinPlaneDot = 0.87F;  // 30 deg.
constexpr float kLargerThan = 1.2F;    // As the verification has it: a plane no larger may be the object's own face.

bool faces_camera(const Eigen::Vector3f& p, const Eigen::Vector3f& n) { return -n.dot(p) > kMinFacing * p.norm(); }

// Mean distance to the nearest other sample.
float spacing_of(const std::vector<Eigen::Vector3f>& points) {
  double sum = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    float nearest_sq = std::numeric_limits<float>::infinity();
    for (std::size_t j = 0; j < points.size(); ++j)
      if (j != i) nearest_sq = std::min(nearest_sq, (points[i] - points[j]).squaredNorm());
    sum += std::sqrt(static_cast<double>(nearest_sq));
  }
  return points.size() < 2 ? 0 : static_cast<float>(sum / static_cast<double>(points.size()));
}

std::vector<SampleBlock> to_blocks(const std::vector<Eigen::Vector3f>& points,
                                   const std::vector<Eigen::Vector3f>& normals) {
  constexpr std::size_t kSize = SampleBlock::kSize;
  std::vector<SampleBlock> blocks((points.size() + kSize - 1) / kSize);
  for (std::size_t i = 0; i < points.size(); ++i) {
    SampleBlock& block = blocks[i / kSize];
    const std::size_t k = i % kSize;
    block.x[k] = points[i].x();
    block.y[k] = points[i].y();
    block.z[k] = points[i].z();
    block.nx[k] = normals[i].x();
    block.ny[k] = normals[i].y();
    block.nz[k] = normals[i].z();
  }
  return blocks;
}

// The extent of the largest plane that a pixel lies on.
float plane_extent_at(const OrganizedCloud& cloud, std::size_t pixel, std::span<const ScenePlane> planes) {
  float extent_m = 0;
  if (!cloud.has_normal(pixel)) return extent_m;
  const Eigen::Vector3f p = cloud.point(pixel);
  const Eigen::Vector3f n = cloud.normal(pixel);
  for (const ScenePlane& plane : planes)
    if (plane.extent_m > std::max(extent_m, kMinPlane_m) && std::abs(plane.signed_distance(p)) <= kPlaneDistance_m &&
        plane.normal.dot(n) >= kMinPlaneDot && plane.covers(p))
      extent_m = plane.extent_m;
  return extent_m;
}

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
  result.blocks = to_blocks(result.points, result.normals);
  result.spacing_m = spacing_of(result.points);
  result.center = model.center;
  result.diameter_m = model.diameter_m;
  for (const Eigen::Vector3f& p : result.points)
    result.radius_m = std::max<double>(result.radius_m, (p - result.center).norm());
  return result;
}

PoseProbe::PoseProbe(const PreparedView& view, std::span<const ScenePlane> planes, int num_threads)
    : view_(view),
      pixels_(view.cloud.width(), view.cloud.height()),
      lab_(view.cloud.width(), view.cloud.height()),
      fx_(static_cast<float>(view.frame.camera.fx)),
      fy_(static_cast<float>(view.frame.camera.fy)),
      cx_(static_cast<float>(view.frame.camera.cx) + 0.5F),
      cy_(static_cast<float>(view.frame.camera.cy) + 0.5F) {
  parallel_for_blocks(lab_.size(), 4096, num_threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      lab_[i] = to_lab(view.frame.color[i]);
      pixels_[i] = {view.cloud.z[i], plane_extent_at(view.cloud, i, planes), chroma(lab_[i])};
    }
  });
}

Image<std::uint8_t> PoseProbe::off_larger_planes(float diameter_m) const {
  Image<std::uint8_t> mask(pixels_.width(), pixels_.height());
  for (std::size_t i = 0; i < mask.size(); ++i)
    mask[i] = pixels_[i].plane_extent_m > kLargerThan * diameter_m ? 0 : 255;
  return mask;
}

bool PoseProbe::is_background(std::size_t pixel, const ProbeModel& model) const {
  return pixels_[pixel].plane_extent_m > kLargerThan * model.diameter_m;
}

int PoseProbe::pixel_of(const Eigen::Vector3f& p) const {
  if (!(p.z() > kMinDepth_m)) return -1;
  const float u = fx_ * p.x() / p.z() + cx_;
  const float v = fy_ * p.y() / p.z() + cy_;
  if (!(u >= 0 && v >= 0 && u < static_cast<float>(lab_.width()) && v < static_cast<float>(lab_.height()))) return -1;
  return static_cast<int>(lab_.index(static_cast<int>(u), static_cast<int>(v)));
}

float PoseProbe::tolerance_at(float z_m, double tolerance_m, double sigmas) const {
  const double seen_z_m = std::max(kMinDepth_m, z_m);  // The centre may lie behind the camera.
  return static_cast<float>(tolerance_m + sigmas * nguyen_noise(seen_z_m, 0, view_.frame.camera.fx).axial_m);
}

SampleCounts PoseProbe::count(const ProbeModel& model, const Rigid3f& camera_from_object,
                              const CountSamplesOptions& options) const {
  SampleCounts counts;
  const float max_chroma_sq = static_cast<float>(options.max_chroma_difference * options.max_chroma_difference);
  const float tolerance =
      tolerance_at((camera_from_object * model.center).z(), options.tolerance_m, options.tolerance_sigmas);
  std::size_t i = 0;
  for (const SampleBlock& block : model.blocks) {
    const Projected seen = project(block, camera_from_object);
    for (std::size_t k = 0; k < SampleBlock::kSize; ++k, ++i) {
      if (seen.faces[k] == 0) continue;
      ++counts.facing;
      if (seen.pixel[k] < 0) {
        ++counts.hidden;
      } else {
        const Pixel& pixel = pixels_[static_cast<std::size_t>(seen.pixel[k])];
        if (std::isnan(pixel.z_m)) continue;
        if (seen.z_m[k] > pixel.z_m + tolerance) {
          ++counts.hidden;
        } else if (seen.z_m[k] < pixel.z_m - tolerance || pixel.plane_extent_m > kLargerThan * model.diameter_m) {
          ++counts.through;
        } else {
          ++counts.confirmed;
          if (!model.chroma.empty() && (model.chroma[i] - pixel.chroma).squaredNorm() > max_chroma_sq)
            ++counts.off_color;
        }
      }
      counts.gave_up = counts.through + counts.off_color > options.max_wrong + counts.facing / 4;
      if (counts.gave_up || counts.facing == options.max_samples) return counts;
    }
  }
  return counts;
}

PoseProbe::Projected PoseProbe::project(const SampleBlock& block, const Rigid3f& camera_from_object) const {
  const Eigen::Matrix3f& r = camera_from_object.rotation;
  const Eigen::Vector3f& t = camera_from_object.translation;
  const auto width = static_cast<float>(lab_.width());
  const auto height = static_cast<float>(lab_.height());
  std::array<float, SampleBlock::kSize> u;
  std::array<float, SampleBlock::kSize> v;
  Projected result;
  for (std::size_t k = 0; k < SampleBlock::kSize; ++k) {  // No branches: the compiler makes vector code of it.
    const float x = r(0, 0) * block.x[k] + r(0, 1) * block.y[k] + r(0, 2) * block.z[k] + t.x();
    const float y = r(1, 0) * block.x[k] + r(1, 1) * block.y[k] + r(1, 2) * block.z[k] + t.y();
    const float z = r(2, 0) * block.x[k] + r(2, 1) * block.y[k] + r(2, 2) * block.z[k] + t.z();
    const float nx = r(0, 0) * block.nx[k] + r(0, 1) * block.ny[k] + r(0, 2) * block.nz[k];
    const float ny = r(1, 0) * block.nx[k] + r(1, 1) * block.ny[k] + r(1, 2) * block.nz[k];
    const float nz = r(2, 0) * block.nx[k] + r(2, 1) * block.ny[k] + r(2, 2) * block.nz[k];
    const float facing = -(nx * x + ny * y + nz * z);
    const float least = kMinFacing * kMinFacing * (x * x + y * y + z * z);
    result.faces[k] = static_cast<std::uint8_t>((facing > 0) & (facing * facing > least));
    const float inverse_z = 1 / std::max(z, kMinDepth_m);
    u[k] = fx_ * x * inverse_z + cx_;
    v[k] = fy_ * y * inverse_z + cy_;
    const bool inside = (z > kMinDepth_m) & (u[k] >= 0) & (v[k] >= 0) & (u[k] < width) & (v[k] < height);
    u[k] = inside ? u[k] : -1.0F;
    result.z_m[k] = z;
  }
  for (std::size_t k = 0; k < SampleBlock::kSize; ++k)
    result.pixel[k] = u[k] < 0 ? -1 : static_cast<int>(v[k]) * lab_.width() + static_cast<int>(u[k]);
  return result;
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
    if (pixel < 0) {
      ++confirmed.hidden;
      continue;
    }
    const auto at = static_cast<std::size_t>(pixel);
    confirmed.outline.emplace_back(pixel % lab_.width(), pixel / lab_.width());
    const float depth = view_.cloud.z[at];
    if (std::isnan(depth)) continue;
    if (p.z() > depth + tolerance) {
      ++confirmed.hidden;
    } else if (p.z() < depth - tolerance || is_background(at, model) ||
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
  const ColorTolerance tolerance(options.color_sigma_l, options.color_sigma_ab);
  std::vector<LabColor> seen;
  std::vector<LabColor> expected;
  fit.num_explained = 0;
  for (std::size_t k = 0; k < confirmed.samples.size(); ++k) {
    expected.push_back(to_lab(light(confirmed.model_light[k], confirmed.normals[k])));
    seen.push_back(lab_[confirmed.pixels[k]]);
    if (std::exp(-tolerance.exponent(expected[k], seen[k])) > options.min_inlier_weight) ++fit.num_explained;
  }
  fit.pattern_similarity = pattern_similarity(expected, seen, options.color_sigma_l / options.color_sigma_ab);
}

double PoseProbe::count_continuing(const ProbeModel& model, const Confirmed& confirmed,
                                   const VerifyOptions& options) const {
  const float z = view_.cloud.z[confirmed.pixels.front()];
  const float cell_px = std::max(2.0F, kCellSpacings * model.spacing_m * static_cast<float>(view_.frame.camera.fx) / z);
  Silhouette silhouette(confirmed.outline, cell_px);
  for (std::size_t k = 0; k < confirmed.pixels.size(); ++k) {
    const auto pixel = static_cast<int>(confirmed.pixels[k]);
    silhouette.set_known(Eigen::Vector2f(pixel % lab_.width(), pixel / lab_.width()), pixel);
  }
  const ColorTolerance tolerance(options.color_sigma_l, options.color_sigma_ab);
  const auto continues = [&](std::size_t from, std::size_t to) {
    if (!view_.cloud.has_normal(from) || !view_.cloud.has_normal(to)) return false;
    const Eigen::Vector3f normal = view_.cloud.normal(from);
    return std::abs(normal.dot(view_.cloud.point(to) - view_.cloud.point(from))) < kMaxContinuationOffset_m &&
           normal.dot(view_.cloud.normal(to)) > kMinContinuationDot &&
           tolerance.exponent(lab_[from], lab_[to]) < kMaxContinuationExponent;
  };
  int num_cells = 0;
  silhouette.visit_around([&](const Eigen::Vector2f& px, int known_pixel) {
    const int u = static_cast<int>(px.x());
    const int v = static_cast<int>(px.y());
    if (px.x() < 0 || px.y() < 0 || u >= lab_.width() || v >= lab_.height()) return false;
    const bool goes_on = continues(static_cast<std::size_t>(known_pixel), lab_.index(u, v));
    num_cells += goes_on ? 1 : 0;
    return goes_on;
  });
  return num_cells * static_cast<double>(kCellSpacings * kCellSpacings);
}

PoseFit PoseProbe::judge(const ProbeModel& model, const Rigid3& camera_from_object, double tolerance_m,
                         const VerifyOptions& colors) const {
  const Confirmed confirmed = confirm(model, camera_from_object, tolerance_m);
  PoseFit fit;
  if (confirmed.samples.empty()) return fit;
  fit.num_explained = static_cast<int>(confirmed.samples.size());
  if (!confirmed.model_light.empty()) compare_colors(confirmed, colors, fit);
  fit.visible_share = 1 - static_cast<double>(confirmed.hidden) / confirmed.facing;
  const double num_visible = static_cast<double>(confirmed.samples.size()) + static_cast<double>(confirmed.wrong);
  fit.explained_share = fit.num_explained / (num_visible + count_continuing(model, confirmed, colors));
  return fit;
}

void set_white_balance(ProbeModel& model, const Eigen::Array3f& white_balance) {
  model.chroma.clear();
  for (const Eigen::Vector3f& color : model.linear_light)
    model.chroma.push_back(chroma(to_lab((color.array() * white_balance.exp()).min(1.0F).matrix().eval())));
}

}  // namespace resight
