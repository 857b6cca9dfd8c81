// SPDX-License-Identifier: Apache-2.0
#include "resight/shape_search/pose_scorer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "resight/appearance/pattern_similarity.hpp"
#include "resight/core/check.hpp"
#include "resight/core/parallel.hpp"
#include "resight/registration/point_to_plane.hpp"
#include "resight/segmentation/surface_continuation.hpp"
#include "resight/sensor/noise_model.hpp"
#include "resight/shape_search/scene_samples.hpp"
#include "resight/shape_search/silhouette.hpp"

namespace resight {
namespace {

constexpr double kSpacingShare = 0.05;   // Of the diameter; grows until max_samples suffice.
constexpr double kMinSpacing_m = 0.005;  // The resolution of verification.
constexpr float kMinFacing = 0.25F;      // Cosine between normal and viewing ray: steeper ones are measured badly.
constexpr float kMinNormalDot = 0.5F;    // 60 deg, as kMaxInlierAngle_rad of verification.
constexpr float kMinDepth_m = 0.05F;     // Nearer points are beside or behind the camera.
constexpr int kMinPairs = 15;            // Fewer hold six unknowns too weakly.
constexpr float kCellSpacings = 1.5F;    // Cells of a silhouette, in spacings of the samples: without holes.
constexpr float kMaxContinuationOffset_m = 0.005F;  // As ContinuationClutter::max_offset_m of verification.
constexpr float kMaxGain = 0.25F;    // Of a score, from few samples to all: 0.5 % of the poses that hold gain more.
constexpr float kMinPlane_m = 0.1F;  // Smaller planes may be faces of any object.
constexpr float kPlaneDistance_m = 0.01F;  // As PlaneOptions::max_distance_m of verification.
constexpr float kMinPlaneDot = 0.87F;      // 30 deg: normals of single pixels are noisy.
const Eigen::Vector3f kNoNormal = Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());

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

bool holds(const ScenePlane& plane, const Eigen::Vector3f& p, const Eigen::Vector3f& n, const DepthNoise& noise) {
  if (plane.noise_scale == 0) return plane.holds(p, n, kPlaneDistance_m, kMinPlaneDot);
  const auto noise_m = static_cast<float>(axial_noise_m(noise, static_cast<double>(p.z())));
  return plane.holds(p, n, plane.tolerance_m(noise_m), ScenePlane::kMinNoisyDot);
}

// The extent of the largest plane that a pixel lies on.
float plane_extent_at(const OrganizedCloud& cloud, std::size_t pixel, std::span<const ScenePlane> planes,
                      const DepthNoise& noise) {
  float extent_m = 0;
  if (!cloud.has_normal(pixel)) return extent_m;
  const Eigen::Vector3f p = cloud.point(pixel);
  const Eigen::Vector3f n = cloud.normal(pixel);
  for (const ScenePlane& plane : planes)
    if (plane.extent_m > std::max(extent_m, kMinPlane_m) && holds(plane, p, n, noise)) extent_m = plane.extent_m;
  return extent_m;
}

void set_colors(SampledModel& model, std::vector<Rgb8> colors) {
  model.colors = std::move(colors);
  model.linear_light = to_linear_light(model.colors);
  set_white_balance(model, Eigen::Array3f::Zero());
}

}  // namespace

void CountSamplesOptions::check() const {
  check_positive("CountSamplesOptions.max_samples", max_samples);
  check_not_negative("CountSamplesOptions.max_wrong", max_wrong);
  check_options("CountSamplesOptions.margin", margin);
  check_positive("CountSamplesOptions.margin.base_m", margin.base_m);
  check_positive("CountSamplesOptions.max_chroma_difference", max_chroma_difference);
}

SampledModel make_sampled_model(const ObjectModel& model, int max_samples) {
  const double spacing_m = std::max(kMinSpacing_m, kSpacingShare * static_cast<double>(model.diameter_m));
  PointCloud samples = sample_surface(model.surface, spacing_m, max_samples);
  SampledModel result;
  if (samples.has_colors()) set_colors(result, std::move(samples.colors));
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

SampledModel to_grey(SampledModel model) {
  std::ranges::transform(model.colors, model.colors.begin(), [](Rgb8 c) { return to_grey(c); });
  set_colors(model, std::move(model.colors));
  return model;
}

PoseScorer::PoseScorer(const PreparedView& view, std::span<const ScenePlane> planes, int num_threads)
    : view_(view),
      pixels_(view.cloud.width(), view.cloud.height()),
      oriented_(view.cloud.width(), view.cloud.height()),
      lab_(view.cloud.width(), view.cloud.height()),
      fx_(static_cast<float>(view.frame.camera.fx)),
      fy_(static_cast<float>(view.frame.camera.fy)),
      cx_(static_cast<float>(view.frame.camera.cx) + 0.5F),
      cy_(static_cast<float>(view.frame.camera.cy) + 0.5F) {
  const Image<Rgb8>& colors = view.surface_color();
  parallel_for_blocks(lab_.size(), 4096, num_threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      lab_[i] = to_lab(colors[i]);
      pixels_[i] = {view.frame.depth_m[i], plane_extent_at(view.cloud, i, planes, view.frame.camera.noise),
                    chroma(lab_[i])};
      const Eigen::Vector3f normal = view.cloud.has_normal(i) ? view.cloud.normal(i) : kNoNormal;
      oriented_[i] = {view.cloud.z[i], normal.x(), normal.y(), normal.z()};
    }
  });
}

Image<std::uint8_t> PoseScorer::off_larger_planes(float diameter_m) const {
  Image<std::uint8_t> mask(pixels_.width(), pixels_.height());
  for (std::size_t i = 0; i < mask.size(); ++i)
    mask[i] = is_larger_than_object(pixels_[i].plane_extent_m, diameter_m) ? 0 : 255;
  return mask;
}

int PoseScorer::pixel_of(const Eigen::Vector3f& p) const {
  if (!(p.z() > kMinDepth_m)) return -1;
  const float u = fx_ * p.x() / p.z() + cx_;
  const float v = fy_ * p.y() / p.z() + cy_;
  if (!(u >= 0 && v >= 0 && u < static_cast<float>(lab_.width()) && v < static_cast<float>(lab_.height()))) return -1;
  return static_cast<int>(lab_.index(static_cast<int>(u), static_cast<int>(v)));
}

float PoseScorer::margin_at_center(const SampledModel& model, const Rigid3f& camera_from_object,
                                   const DepthMargin& margin) const {
  const float z_m = (camera_from_object * model.center).z();
  return margin.at(std::max(kMinDepth_m, z_m), view_.frame.camera.noise);  // The centre may lie behind the camera.
}

// classify_surface() for vector instructions: no branches in its loops, and one margin for all samples of a pose.
SampleCounts PoseScorer::score_coarse(const SampledModel& model, const Rigid3f& camera_from_object,
                                      const CountSamplesOptions& options, double min_score) const {
  SampleCounts counts;
  const bool has_colors = !model.chroma.empty();
  const float max_chroma_difference = static_cast<float>(options.max_chroma_difference);
  const float margin_m = margin_at_center(model, camera_from_object, options.margin);
  for (std::size_t b = 0; b < model.blocks.size(); ++b) {
    const PosedBlock posed = project(model.blocks[b], camera_from_object);
    std::array<Pixel, SampleBlock::kSize> pixels;
    for (std::size_t k = 0; k < SampleBlock::kSize; ++k) pixels[k] = pixels_[static_cast<std::size_t>(posed.pixel[k])];
    const Eigen::Vector2f* chroma = has_colors ? &model.chroma[b * SampleBlock::kSize] : nullptr;
    for (std::size_t k = 0; k < SampleBlock::kSize; ++k) {
      const Pixel& pixel = pixels[k];
      const float ahead_m = pixel.z_m - posed.samples.z[k];  // NaN: no comparison holds.
      const int measured = posed.faces[k] & posed.inside[k];
      const int near = measured & int{std::abs(ahead_m) <= margin_m};
      const int on_plane = int{is_larger_than_object(pixel.plane_extent_m, model.diameter_m)};
      const int confirmed = near & ~on_plane;
      counts.facing += posed.faces[k];
      counts.occluded += (posed.faces[k] & ~posed.inside[k]) | (measured & int{ahead_m < -margin_m});
      counts.seen_through += (measured & int{ahead_m > margin_m}) | (near & on_plane);
      counts.confirmed += confirmed;
      if (has_colors)
        counts.wrong_color += confirmed & int{!is_similar_chroma(chroma[k], pixel.chroma, max_chroma_difference)};
    }
    const float share_left = 1 - static_cast<float>(counts.facing) / static_cast<float>(options.max_samples);
    counts.gave_up = counts.seen_through + counts.wrong_color > options.max_wrong + counts.facing / 4 ||
                     counts.score() < static_cast<float>(min_score) - kMaxGain * std::max(0.0F, share_left);
    if (counts.gave_up || counts.facing >= options.max_samples) break;
  }
  return counts;
}

PoseScorer::PosedBlock PoseScorer::project(const SampleBlock& block, const Rigid3f& camera_from_object) const {
  const Eigen::Matrix3f& r = camera_from_object.rotation;
  const Eigen::Vector3f& t = camera_from_object.translation;
  const auto width = static_cast<float>(lab_.width());
  const auto height = static_cast<float>(lab_.height());
  PosedBlock posed;
  for (std::size_t k = 0; k < SampleBlock::kSize; ++k) {
    const float x = r(0, 0) * block.x[k] + r(0, 1) * block.y[k] + r(0, 2) * block.z[k] + t.x();
    const float y = r(1, 0) * block.x[k] + r(1, 1) * block.y[k] + r(1, 2) * block.z[k] + t.y();
    const float z = r(2, 0) * block.x[k] + r(2, 1) * block.y[k] + r(2, 2) * block.z[k] + t.z();
    const float nx = r(0, 0) * block.nx[k] + r(0, 1) * block.ny[k] + r(0, 2) * block.nz[k];
    const float ny = r(1, 0) * block.nx[k] + r(1, 1) * block.ny[k] + r(1, 2) * block.nz[k];
    const float nz = r(2, 0) * block.nx[k] + r(2, 1) * block.ny[k] + r(2, 2) * block.nz[k];
    const float facing = -(nx * x + ny * y + nz * z);
    const float least = kMinFacing * kMinFacing * (x * x + y * y + z * z);
    const float inverse_z = 1 / std::max(z, kMinDepth_m);
    const float u = fx_ * x * inverse_z + cx_;
    const float v = fy_ * y * inverse_z + cy_;
    const bool inside = (z > kMinDepth_m) & (u >= 0) & (v >= 0) & (u < width) & (v < height);
    posed.faces[k] = int{(facing > 0) & (facing * facing > least)};
    posed.inside[k] = int{inside};
    posed.column[k] = static_cast<int>(inside ? u : 0.0F);
    posed.row[k] = static_cast<int>(inside ? v : 0.0F);
    posed.pixel[k] = posed.row[k] * lab_.width() + posed.column[k];
    posed.samples.x[k] = x;
    posed.samples.y[k] = y;
    posed.samples.z[k] = z;
    posed.samples.nx[k] = nx;
    posed.samples.ny[k] = ny;
    posed.samples.nz[k] = nz;
  }
  return posed;
}

StepEquations PoseScorer::linearize(const SampledModel& model, const Rigid3& camera_from_object,
                                    double max_distance_m) const {
  const Rigid3f motion(camera_from_object);
  const Eigen::Vector3f middle = motion * model.center;
  const float inverse_distance_sq = static_cast<float>(1 / (max_distance_m * max_distance_m));
  BlockEquations equations(model.radius_m);
  for (const SampleBlock& block : model.blocks) {
    const PosedBlock posed = project(block, motion);
    const SampleBlock& p = posed.samples;
    std::array<OrientedPixel, SampleBlock::kSize> pixels;
    for (std::size_t k = 0; k < SampleBlock::kSize; ++k)
      pixels[k] = oriented_[static_cast<std::size_t>(posed.pixel[k])];
    PairBlock pairs;
    for (std::size_t k = 0; k < SampleBlock::kSize; ++k) {
      const OrientedPixel& m = pixels[k];
      const float dx = (static_cast<float>(posed.column[k]) + 0.5F - cx_) / fx_ * m.z_m - p.x[k];
      const float dy = (static_cast<float>(posed.row[k]) + 0.5F - cy_) / fy_ * m.z_m - p.y[k];
      const float dz = m.z_m - p.z[k];
      const float u = 1 - (dx * dx + dy * dy + dz * dz) * inverse_distance_sq;
      const float dot = m.nx * p.nx[k] + m.ny * p.ny[k] + m.nz * p.nz[k];
      const bool is_pair = ((posed.faces[k] & posed.inside[k]) != 0) & (u > 0) & (dot >= kMinNormalDot);  // False: NaN.
      pairs.arm[0][k] = p.x[k] - middle.x();
      pairs.arm[1][k] = p.y[k] - middle.y();
      pairs.arm[2][k] = p.z[k] - middle.z();
      pairs.normal[0][k] = is_pair ? m.nx : 0;
      pairs.normal[1][k] = is_pair ? m.ny : 0;
      pairs.normal[2][k] = is_pair ? m.nz : 0;
      pairs.residual[k] = is_pair ? m.nx * dx + m.ny * dy + m.nz * dz : 0;
      pairs.weight[k] = is_pair ? u * u : 0;
    }
    equations.add(pairs);
  }
  return equations.sum();
}

Rigid3 PoseScorer::refine(const SampledModel& model, const Rigid3& camera_from_object, int max_iterations,
                          double max_distance_m) const {
  Rigid3 pose = camera_from_object;
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    const StepEquations equations = linearize(model, pose, max_distance_m);
    if (equations.num_pairs < kMinPairs) break;
    if (equations.step(pose, model.center.cast<double>(), model.radius_m) < StepEquations::kStill_m) break;
  }
  return pose;
}

PoseScorer::Confirmed PoseScorer::confirm(const SampledModel& model, const Rigid3& camera_from_object,
                                          const DepthMargin& margin) const {
  const Rigid3f motion(camera_from_object);
  const float margin_m = margin_at_center(model, motion, margin);
  Confirmed confirmed;
  for (std::size_t b = 0; b < model.blocks.size(); ++b) {
    const PosedBlock posed = project(model.blocks[b], motion);
    for (std::size_t k = 0; k < SampleBlock::kSize; ++k)
      if (posed.faces[k] != 0) confirm_sample(model, b * SampleBlock::kSize + k, posed, k, margin_m, confirmed);
  }
  return confirmed;
}

void PoseScorer::confirm_sample(const SampledModel& model, std::size_t sample, const PosedBlock& posed, std::size_t k,
                                float margin_m, Confirmed& confirmed) const {
  ++confirmed.facing;
  if (posed.inside[k] == 0) {
    ++confirmed.occluded;
    return;
  }
  const auto at = static_cast<std::size_t>(posed.pixel[k]);
  confirmed.outline.emplace_back(posed.column[k], posed.row[k]);
  const Pixel& pixel = pixels_[at];
  const Evidence evidence = compare_depth(posed.samples.z[k], pixel.z_m, margin_m);
  if (evidence == Evidence::kUnobserved) return;
  const Eigen::Vector3f normal(posed.samples.nx[k], posed.samples.ny[k], posed.samples.nz[k]);
  if (evidence == Evidence::kOccluded) {
    ++confirmed.occluded;
  } else if (evidence == Evidence::kSeenThrough ||
             oriented_[at].normal().dot(normal) < kMinNormalDot) {  // Not so without a normal.
    ++confirmed.wrong;
  } else {
    const bool is_on_plane = is_larger_than_object(pixel.plane_extent_m, model.diameter_m);
    SeenSamples& seen = is_on_plane ? confirmed.on_plane : confirmed;
    seen.pixels.push_back(at);
    if (model.linear_light.empty()) return;
    seen.colors.model.push_back(model.linear_light[sample]);
    seen.colors.scene.push_back(to_linear_light(view_.surface_color()[at]));
    seen.colors.normals.push_back(normal);
  }
}

PhotometricFit PoseScorer::fit_photometry(const SampledModel& model, const Rigid3& camera_from_object,
                                          const DepthMargin& margin, const PhotometricLimits& limits) const {
  return resight::fit_photometry(confirm(model, camera_from_object, margin).colors, limits);
}

std::vector<LabColor> PoseScorer::lab_of(const SeenSamples& samples) const {
  std::vector<LabColor> lab;
  lab.reserve(samples.pixels.size());
  for (const std::size_t pixel : samples.pixels) lab.push_back(lab_[pixel]);
  return lab;
}

bool PoseScorer::shares_texture(const SeenSamples& samples, const MatchCriteria& criteria) const {
  if (!criteria.texture_contrast || samples.colors.empty()) return false;
  const PhotometricFit light = resight::fit_photometry(samples.colors, criteria.appearance.light);
  const TextureMatch match = match_texture(to_lab(samples.colors.model), adapt_colors(samples.colors, light),
                                           lab_of(samples), criteria.appearance);
  return weigh_shared_texture(match.shared_texture, *criteria.texture_contrast) > 0.5;
}

// The faces of boxes in a row lie in one plane, like a piece of the table.
void PoseScorer::assign_planes(Confirmed& confirmed, bool belong_to_object) const {
  const SeenSamples planes = std::exchange(confirmed.on_plane, {});
  if (!belong_to_object) {
    confirmed.wrong += static_cast<int>(planes.pixels.size());
    return;
  }
  const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
  append(confirmed.pixels, planes.pixels);
  append(confirmed.colors.model, planes.colors.model);
  append(confirmed.colors.scene, planes.colors.scene);
  append(confirmed.colors.normals, planes.colors.normals);
}

// Counts as explained only what is of like colour, too.
void PoseScorer::compare_colors(const Confirmed& confirmed, const MatchCriteria& criteria, PoseFit& fit) const {
  const PhotometricFit light = resight::fit_photometry(confirmed.colors, criteria.appearance.light);
  const std::vector<LabColor> expected = adapt_colors(confirmed.colors, light);
  const std::vector<LabColor> seen = lab_of(confirmed);
  fit.num_explained = count_color_inliers(expected, seen, criteria.min_weight, criteria.appearance);
  fit.pattern_similarity = pattern_similarity(expected, seen, criteria.appearance.chroma_weight);
}

double PoseScorer::count_continuing(const SampledModel& model, const Confirmed& confirmed, bool use_color) const {
  const float z = pixels_[confirmed.pixels.front()].z_m;  // Not of the cloud, which ends at prepare.max_depth_m.
  const float cell_px = std::max(2.0F, kCellSpacings * model.spacing_m * static_cast<float>(view_.frame.camera.fx) / z);
  Silhouette silhouette(confirmed.outline, cell_px);
  for (std::size_t k = 0; k < confirmed.pixels.size(); ++k) {
    const auto pixel = static_cast<int>(confirmed.pixels[k]);
    silhouette.set_known(Eigen::Vector2f(pixel % lab_.width(), pixel / lab_.width()), pixel);
  }
  const auto continues = [&](std::size_t from, std::size_t to) {
    const OrganizedCloud& cloud = view_.cloud;
    return cloud.has_normal(from) && cloud.has_normal(to) &&
           continues_shape({cloud.point(from), cloud.normal(from)}, {cloud.point(to), cloud.normal(to)},
                           kMaxContinuationOffset_m) &&
           (!use_color || continues_color(lab_[from], lab_[to]));
  };
  int num_cells = 0;
  silhouette.visit_around([&](const Eigen::Vector2f& px, int known_pixel) {
    if (!(px.x() >= 0 && px.y() >= 0 && px.x() < static_cast<float>(lab_.width()) &&
          px.y() < static_cast<float>(lab_.height())))
      return false;
    const std::size_t pixel = lab_.index(static_cast<int>(px.x()), static_cast<int>(px.y()));
    const bool goes_on = continues(static_cast<std::size_t>(known_pixel), pixel);
    num_cells += goes_on ? 1 : 0;
    return goes_on;
  });
  const double spacings_per_cell = static_cast<double>(cell_px * z) / (model.spacing_m * view_.frame.camera.fx);
  return num_cells * spacings_per_cell * spacings_per_cell;
}

PoseFit PoseScorer::shape_fit(const Confirmed& confirmed) {
  PoseFit fit;
  if (confirmed.pixels.empty()) return fit;
  fit.num_explained = static_cast<int>(confirmed.pixels.size());
  fit.explained_share = static_cast<double>(fit.num_explained) / (fit.num_explained + confirmed.wrong);
  fit.visible_share = 1 - static_cast<double>(confirmed.occluded) / confirmed.facing;
  return fit;
}

bool PoseScorer::fits_in_shape(const SampledModel& model, const Rigid3& camera_from_object, const DepthMargin& margin,
                               const PoseFit& least) const {
  Confirmed confirmed = confirm(model, camera_from_object, margin);
  assign_planes(confirmed, false);
  return shape_fit(confirmed).reaches(least);
}

PoseFit PoseScorer::score_fine(const SampledModel& model, const Rigid3& camera_from_object, const DepthMargin& margin,
                               const MatchCriteria& criteria, const PoseFit& least) const {
  Confirmed confirmed = confirm(model, camera_from_object, margin);
  assign_planes(confirmed, shares_texture(confirmed.on_plane, criteria));
  PoseFit fit = shape_fit(confirmed);
  if (confirmed.pixels.empty() || !fit.reaches(least)) return fit;
  const double num_visible = fit.num_explained + confirmed.wrong;
  if (!confirmed.colors.empty()) compare_colors(confirmed, criteria, fit);
  fit.explained_share = fit.num_explained / num_visible;
  if (!fit.reaches(least)) return fit;
  fit.explained_share =
      fit.num_explained / (num_visible + count_continuing(model, confirmed, criteria.appearance.use_color));
  return fit;
}

void set_white_balance(SampledModel& model, const Eigen::Array3f& white_balance) {
  model.chroma.clear();
  for (const Eigen::Vector3f& color : model.linear_light)
    model.chroma.push_back(chroma(to_lab((color.array() * white_balance.exp()).min(1.0F).matrix().eval())));
  constexpr std::size_t kSize = SampleBlock::kSize;
  model.chroma.resize((model.chroma.size() + kSize - 1) / kSize * kSize, Eigen::Vector2f::Zero());
}

}  // namespace resight
