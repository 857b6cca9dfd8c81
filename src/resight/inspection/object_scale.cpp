// SPDX-License-Identifier: Apache-2.0
#include "resight/inspection/object_scale.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "resight/core/statistics.hpp"
#include "resight/features/descriptor_index.hpp"
#include "resight/features/sift.hpp"
#include "resight/inspection/depth_values.hpp"
#include "resight/inspection/internal/sure_errors.hpp"
#include "resight/registration/pose_estimation.hpp"

namespace resight {
namespace {

constexpr int kNeighbors = 3;             // Matches per keypoint, as in recognition.
constexpr std::size_t kMaxMatches = 400;  // Of one object in one view, the most similar ones; pairs of them vote.
constexpr int kMinScaleInliers = 15;
constexpr double kInlierDistance = 0.015;  // Of the median depth: 15 mm at a metre.
constexpr double kVoteWidth = 0.1;         // Of a bin of logarithmic scales.
constexpr int kNumVotes = 200;             // Scales from e^-10 to e^10.
constexpr int kNumTriedScales = 3;
constexpr int kScaleSteps = 5;

/// SIFT features of all objects in one index.
struct IndexedObjects {
  FeatureSet features;
  std::vector<int> objects;  ///< Per feature.
};

IndexedObjects index_objects(const ModelLibrary& library) {
  IndexedObjects all;
  for (std::size_t o = 0; o < library.objects.size(); ++o) {
    if (library.objects[o].sift.size() == 0) continue;
    all.features.append(decode(library.objects[o].sift));
    all.objects.resize(all.features.size(), static_cast<int>(o));
  }
  return all;
}

/// The matches of each object, the most similar ones. A small library is the nearest one to all of the scene, so the
/// first ones in the order of keypoints would all be in the upper part of the image.
std::map<int, std::vector<Correspondence>> match_objects(const IndexedObjects& known, const DescriptorIndex& index,
                                                         const FeatureSet& scene) {
  const std::vector<DescriptorMatch> nearest = index.search(scene.descriptors, kNeighbors);
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < nearest.size(); ++i)
    if (nearest[i].index >= 0) order.push_back(i);
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return nearest[i].distance_sq; });
  std::map<int, std::vector<Correspondence>> matches;
  for (const std::size_t i : order) {
    const auto m = static_cast<std::size_t>(nearest[i].index);
    const std::size_t s = i / kNeighbors;
    std::vector<Correspondence>& of_object = matches[known.objects[m]];
    if (of_object.size() < kMaxMatches)
      of_object.push_back({.model_point = known.features.points[m],
                           .model_normal = known.features.normals[m],
                           .scene_point = scene.points[s],
                           .scene_normal = scene.normals[s]});
  }
  return matches;
}

/// The logarithms of the scales for which most pairs of matches vote: the distance of two points in the scene over that
/// in the model. Short distances say little.
std::vector<double> vote_for_scales(const std::vector<Correspondence>& matches, float diameter_m) {
  std::vector<int> votes(kNumVotes, 0);
  for (std::size_t i = 0; i < matches.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const float in_model = (matches[i].model_point - matches[j].model_point).norm();
      const float in_scene = (matches[i].scene_point - matches[j].scene_point).norm();
      if (in_model <= 0 || in_model < 0.15F * diameter_m || in_scene <= 0) continue;
      const auto bin = static_cast<int>(std::floor(std::log(in_scene / in_model) / kVoteWidth)) + kNumVotes / 2;
      if (bin >= 0 && bin < kNumVotes) ++votes[static_cast<std::size_t>(bin)];
    }
  std::vector<double> scales;
  for (int n = 0; n < kNumTriedScales; ++n) {
    const auto best = std::ranges::max_element(votes);
    if (*best == 0) break;
    const auto bin = static_cast<int>(best - votes.begin()) - kNumVotes / 2;
    scales.push_back((bin + 0.5) * kVoteWidth);
    *best = 0;
  }
  return scales;
}

std::vector<Correspondence> scale_model(std::vector<Correspondence> matches, double scale) {
  for (Correspondence& c : matches) c.model_point *= static_cast<float>(scale);
  return matches;
}

/// The factor by which the scene's points lie farther around their mean than the model's, along the latter (least
/// squares), and the pose for a model that is larger by it.
std::pair<double, Rigid3> fit_residual_scale(const std::vector<Correspondence>& matches, const PoseEstimate& pose) {
  Eigen::Vector3d model_mean = Eigen::Vector3d::Zero(), scene_mean = Eigen::Vector3d::Zero();
  const auto num = static_cast<double>(pose.inliers.size());
  for (const int i : pose.inliers) {
    model_mean += matches[static_cast<std::size_t>(i)].model_point.cast<double>() / num;
    scene_mean += matches[static_cast<std::size_t>(i)].scene_point.cast<double>() / num;
  }
  const Eigen::Matrix3d& rotation = pose.scene_from_model.rotation;
  double along = 0, sum_sq = 0;
  for (const int i : pose.inliers) {
    const Correspondence& c = matches[static_cast<std::size_t>(i)];
    const Eigen::Vector3d m = rotation * (c.model_point.cast<double>() - model_mean);
    along += m.dot(c.scene_point.cast<double>() - scene_mean);
    sum_sq += m.squaredNorm();
  }
  const double factor = sum_sq > 0 ? along / sum_sq : 1;
  return {factor, {rotation, scene_mean - rotation * (factor * model_mean)}};
}

/// Scene points are in units of the median depth.
std::optional<ObjectScale> fit_scale(const std::vector<Correspondence>& matches, double log_scale) {
  const EstimatePoseOptions options{.inlier_distance_m = kInlierDistance,
                                    .max_normal_angle_rad = 0.8,
                                    .max_iterations = 500,
                                    .min_inliers = kMinScaleInliers,
                                    .seed = 1};
  std::vector<Correspondence> scaled = scale_model(matches, std::exp(log_scale));
  auto pose = estimate_pose(scaled, options);
  for (int step = 0; pose && step < kScaleSteps; ++step) {
    const auto [factor, scene_from_model] = fit_residual_scale(scaled, *pose);
    if (!(factor > 0.5 && factor < 2)) return std::nullopt;
    log_scale += std::log(factor);
    scaled = scale_model(matches, std::exp(log_scale));
    pose = refine_pose(scaled, scene_from_model, options);
  }
  if (!pose) return std::nullopt;
  return ObjectScale{
      .object = 0, .view = 0, .log_scale = log_scale, .num_matches = static_cast<int>(pose->inliers.size())};
}

/// The scale at which most matches agree; none if the object is not found.
std::optional<ObjectScale> find_object(const std::vector<Correspondence>& matches, float diameter_m) {
  std::optional<ObjectScale> best;
  if (matches.size() < kMinScaleInliers) return best;
  for (const double log_scale : vote_for_scales(matches, diameter_m)) {
    const auto fitted = fit_scale(matches, log_scale);
    if (fitted && (!best || fitted->num_matches > best->num_matches)) best = fitted;
  }
  return best;
}

/// Features of a view whose depths are in units of their median; none without depth.
FeatureSet extract_scaled_features(RgbdFrame frame, double median_m, int num_threads) {
  for (float& z_m : frame.depth_m.data()) z_m = static_cast<float>(z_m / median_m);
  PrepareViewOptions options;
  options.max_pixels = kMaxWorkingPixels;
  options.min_depth_m.reset();
  options.num_threads = num_threads;
  return extract_sift(prepare_view(std::move(frame), options));
}

/// Median of logarithmic scales, and its standard error.
struct ScaleEstimate {
  double log_scale = 0;
  double standard_error = 0;
};

double mean_median(std::vector<double> values) {
  const double upper = upper_median(values);
  if (values.size() % 2 == 1) return upper;
  for (double& v : values) v = -v;
  return 0.5 * (upper - upper_median(std::move(values)));
}

/// Standard deviation of what the values scatter around. The median deviation of few may be near zero by chance.
double find_spread(const std::vector<double>& values, double median) {
  constexpr std::size_t kFew = 10;
  std::vector<double> deviations;
  double sum = 0, sum_sq = 0;
  for (const double v : values) {
    deviations.push_back(std::abs(v - median));
    sum += v - median;
    sum_sq += (v - median) * (v - median);
  }
  const auto num = static_cast<double>(values.size());
  if (values.size() >= kFew) return kNormalizedMad * upper_median(std::move(deviations));
  return num > 1 ? std::sqrt((sum_sq - sum * sum / num) / (num - 1)) : 0;
}

ScaleEstimate estimate_scale(const std::vector<double>& log_scales) {
  constexpr double kOfMedian = 1.2533;  // Standard error of a median over that of a mean, of normal values.
  const double median = mean_median(log_scales);
  return {median, kOfMedian * find_spread(log_scales, median) / std::sqrt(static_cast<double>(log_scales.size()))};
}

constexpr std::size_t kMinSightings = 3;
constexpr double kMaxLogSize = 0.06;  // Factory calibrations of depth differ by up to 4 % (TUM RGB-D: 3.5 %).
constexpr double kMaxLogOwnSize = 0.1;

/// From here on, a size is wrong.
double limit_of(double limit, const ScaleEstimate& e, std::size_t num_sightings) {
  return std::max(limit, inspection::sure_errors(num_sightings, 1) * e.standard_error);
}

std::optional<double> excess_of(const std::vector<double>& log_scales, double limit) {
  if (log_scales.size() < kMinSightings) return std::nullopt;
  const ScaleEstimate e = estimate_scale(log_scales);
  const double excess = std::abs(e.log_scale) / limit_of(limit, e, log_scales.size());
  return excess > 1 ? std::optional(excess) : std::nullopt;
}

Finding make_finding(const std::string& who, const std::vector<double>& log_scales, double limit, double margin,
                     int view, const std::string& remedy) {
  const ScaleEstimate e = estimate_scale(log_scales);
  const double scale = std::exp(e.log_scale);
  return {.fault = "model_size",
          .message = fmt::format("{} {:.4g} times as large as in the library (+- {:.1f} %, found {} times)", who, scale,
                                 100 * e.standard_error, log_scales.size()),
          .remedy = remedy,
          .value = scale,
          .unit = "",
          .threshold = std::exp(limit_of(limit, e, log_scales.size())),
          .margin = margin,
          .view = view};
}

}  // namespace

Result<ObjectScales> measure_object_scales(const Sequence& sequence, const ModelLibrary& library,
                                           const MeasureObjectScalesOptions& options) {
  ObjectScales scales;
  for (const ObjectModel& object : library.objects) scales.num_objects += object.sift.size() > 0 ? 1 : 0;
  scales.num_views = std::min(options.max_views, sequence.num_views());
  if (scales.num_objects == 0) return scales;
  const IndexedObjects known = index_objects(library);
  const DescriptorIndex index(known.features.descriptors, known.features.dimension,
                              {.num_cells = {}, .num_components = {}, .num_threads = options.num_threads});
  for (int i = 0; i < scales.num_views; ++i) {
    const int view = scales.num_views == 1 ? 0 : i * (sequence.num_views() - 1) / (scales.num_views - 1);
    auto frame = sequence.read_view(view);
    if (!frame.ok()) return frame.error();
    const double median_m = measure_depth_values(frame->depth_m).median_m;
    if (std::isnan(median_m)) continue;
    const FeatureSet features = extract_scaled_features(std::move(frame).value(), median_m, options.num_threads);
    for (const auto& [object, matches] : match_objects(known, index, features)) {
      auto found = find_object(matches, library.objects[static_cast<std::size_t>(object)].diameter_m);
      if (!found) continue;
      found->object = object;
      found->view = view;
      found->log_scale += std::log(median_m);
      scales.found.push_back(*found);
    }
  }
  return scales;
}

std::vector<Finding> find_scale_faults(const ObjectScales& scales, const ModelLibrary& library) {
  std::vector<double> all;
  std::map<int, std::vector<double>> of_object;
  for (const ObjectScale& found : scales.found) {
    all.push_back(found.log_scale);
    of_object[found.object].push_back(found.log_scale);
  }
  std::vector<Finding> findings;
  if (const auto margin = excess_of(all, kMaxLogSize)) {
    findings.push_back(make_finding(
        "the known objects are", all, kMaxLogSize, *margin, scales.found.front().view,
        fmt::format("train them again with the right --mesh-unit; or, if they are right, --depth-scale {:.3g} times "
                    "the present one",
                    std::exp(-estimate_scale(all).log_scale))));
    return findings;
  }
  for (const auto& [object, log_scales] : of_object)
    if (const auto margin = excess_of(log_scales, kMaxLogOwnSize))
      findings.push_back(make_finding(library.objects[static_cast<std::size_t>(object)].name + " is", log_scales,
                                      kMaxLogOwnSize, *margin,
                                      std::ranges::find(scales.found, object, &ObjectScale::object)->view,
                                      "train its model again with the right --mesh-unit, or leave it out"));
  return findings;
}

std::string describe_scales(const ObjectScales& scales) {
  std::vector<double> log_scales;
  for (const ObjectScale& found : scales.found) log_scales.push_back(found.log_scale);
  if (!scales.is_measured())
    return fmt::format("the sizes of the known objects ({} of {} textured ones found in {} views)", log_scales.size(),
                       scales.num_objects, scales.num_views);
  const ScaleEstimate e = estimate_scale(log_scales);
  return fmt::format(
      "known objects are {:.3f} times as large as in the library (+- {:.1f} %, found {} times in {} views)",
      std::exp(e.log_scale), 100 * e.standard_error, log_scales.size(), scales.num_views);
}

}  // namespace resight
