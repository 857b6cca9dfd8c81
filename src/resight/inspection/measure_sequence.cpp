// SPDX-License-Identifier: Apache-2.0
#include "resight/inspection/measure_sequence.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "resight/core/check.hpp"
#include "resight/core/statistics.hpp"
#include "resight/inspection/internal/changed_pairs.hpp"
#include "resight/inspection/pose_readings.hpp"
#include "resight/sensor/color_offset.hpp"
#include "resight/sensor/reduce_frame.hpp"

namespace resight {
namespace {

/// Pairs of views: neighbours, and some farther apart, which tell scale and focal length better.
std::vector<std::pair<int, int>> choose_pairs(int num_views, int max_views) {
  std::vector<std::pair<int, int>> pairs;
  constexpr int kFar = 3;
  if (num_views <= max_views) {
    for (int v = 0; v + 1 < num_views; ++v) {
      pairs.emplace_back(v, v + 1);
      if (v + kFar < num_views) pairs.emplace_back(v, v + kFar);
    }
    return pairs;
  }
  const int num_groups = std::max(1, max_views / 3);
  for (int g = 0; g < num_groups; ++g) {
    const int v = num_groups == 1 ? 0 : g * (num_views - 1 - kFar) / (num_groups - 1);
    pairs.emplace_back(v, v + 1);
    pairs.emplace_back(v, v + kFar);
  }
  return pairs;
}

/// Pairs of the inspected views that are far apart in the sequence, evenly left out so that a few are left. Their error
/// shows drift, which neighbours do not.
std::vector<std::pair<int, int>> choose_far_pairs(const std::vector<int>& views, int num_views) {
  constexpr std::size_t kMaxFarPairs = 24;
  const int min_distance = std::max(6, num_views / 5);
  std::vector<std::pair<int, int>> all;
  for (const int a : views)
    for (const int b : views)
      if (b - a >= min_distance) all.emplace_back(a, b);
  std::vector<std::pair<int, int>> some;
  const std::size_t step = all.size() / kMaxFarPairs + 1;
  for (std::size_t i = 0; i < all.size(); i += step) some.push_back(all[i]);
  return some;
}

std::vector<int> views_of(const std::vector<std::pair<int, int>>& pairs) {
  std::vector<int> views{0};
  for (const auto& [a, b] : pairs) {
    views.push_back(a);
    views.push_back(b);
  }
  std::ranges::sort(views);
  views.erase(std::unique(views.begin(), views.end()), views.end());
  return views;
}

/// What matching needs of the inspected views, by their number.
struct InspectedViews {
  std::map<int, RgbdFrame> frames;
  std::map<int, ContourView> contours;  ///< Of the reduced views. Depths in metres.
};

ViewMeasurements measure_view(int number, const RgbdFrame& frame, int divisor, int num_threads, ShiftScores& scores,
                              InspectedViews& views) {
  ViewMeasurements view;
  view.view = number;
  view.name = frame.name;
  view.depth = measure_depth_values(frame.depth_m);
  view.noise_ratio = measure_noise_ratio(frame.depth_m, frame.camera.fx);
  view.color = measure_color_values(frame.color);
  if (view.depth.measured_share == 0) return view;
  PrepareViewOptions options;
  options.min_depth_m.reset();
  options.num_threads = num_threads;
  const PreparedView prepared = prepare_view(reduce_frame(frame, divisor), options);
  scores.add(prepared);
  views.contours.emplace(number, find_contour_view(prepared));
  view.fine_shift_px = measure_color_offset(prepared);
  return view;
}

double median_shift_px(const ViewPair& pair) {
  std::vector<double> shifts_px;
  for (const MatchedPoint& m : pair.matches) shifts_px.push_back((m.pixel_a - m.pixel_b).norm());
  return upper_median(std::move(shifts_px));
}

using FeaturesOfViews = std::map<int, ViewFeatures>;

/// Those that can be matched.
std::vector<ViewPair> match_pairs(const std::vector<std::pair<int, int>>& pairs, const FeaturesOfViews& features,
                                  const Camera& camera) {
  std::vector<ViewPair> matched;
  for (const auto& [a, b] : pairs) {
    if (!features.contains(a) || !features.contains(b)) continue;
    ViewPair pair = match_view_pair(a, features.at(a), b, features.at(b), camera);
    if (!pair.matches.empty()) matched.push_back(std::move(pair));
  }
  return matched;
}

template <typename ValueOf>
double median_over(const std::vector<ViewPair>& pairs, const ValueOf& value_of) {
  std::vector<double> values;
  for (const ViewPair& pair : pairs) values.push_back(value_of(pair));
  return upper_median(std::move(values));
}

double measure_still_share(const SequenceMeasurements& all, const inspection::DepthOfViews& depths_m) {
  constexpr double kMinSameShare = 0.4;  // Of the measured pixels: most of the scene stays.
  const auto stands_still = [&](const ViewPair& pair) {
    const Image<float>& first = depths_m.at(pair.a);
    const Image<float>& second = depths_m.at(pair.b);
    const Rigid3 moved{pair.b_from_a.rotation, all.depth_unit_m * pair.b_from_a.translation};
    const int num_same = count_same_depth(first, second, all.camera, Rigid3());
    return num_same > kMinSameShare * count_same_depth(first, first, all.camera, Rigid3()) &&
           num_same >= count_same_depth(first, second, all.camera, moved);
  };
  return static_cast<double>(std::ranges::count_if(all.pairs, stands_still)) / static_cast<double>(all.pairs.size());
}

/// Whether the camera moves so slowly that only views far apart tell of intrinsics and poses, as at video rate.
bool is_slow(const SequenceMeasurements& all) {
  constexpr double kSlow_px = 5;
  constexpr std::size_t kMinFarPairs = 3;
  const double near_px = median_over(all.pairs, median_shift_px);
  const double slow_px = kSlow_px * all.pixel_scale();
  return near_px < slow_px && all.far_pairs.size() >= kMinFarPairs &&
         median_over(all.far_pairs, median_shift_px) > std::max(slow_px, 2 * near_px);
}

/// Whether pixels of both cameras may be taken for one another: single views may have their own calibration.
bool is_similar(const Camera& a, const Camera& b) {
  constexpr double kMaxDifference = 0.01;  // Of the focal length and of the image's width: some pixels at the border.
  return a.width == b.width && a.height == b.height && std::abs(a.fx - b.fx) <= kMaxDifference * a.fx &&
         std::abs(a.fy - b.fy) <= kMaxDifference * a.fy && std::abs(a.cx - b.cx) <= kMaxDifference * a.width &&
         std::abs(a.cy - b.cy) <= kMaxDifference * a.width;
}

/// Whether features can be found and projected.
bool is_usable(const SequenceMeasurements& all) {
  const Camera& c = all.camera;
  const auto is_focal = [&](double f) { return f > 0.05 * c.width && f < 50 * c.width; };
  return is_focal(c.fx) && is_focal(c.fy) && std::isfinite(all.depth_unit_m) && all.depth_unit_m > 0;
}

}  // namespace

Result<SequenceMeasurements> measure_sequence(const Sequence& sequence, const MeasureSequenceOptions& options) {
  require(options.max_views >= 3, "max_views: must be at least 3");
  SequenceMeasurements all;
  all.num_views = sequence.num_views();
  all.has_poses = sequence.has_poses();
  const auto pairs = choose_pairs(all.num_views, options.max_views);
  const std::vector<int> inspected = views_of(pairs);
  InspectedViews views;
  std::vector<double> medians_m;
  for (const int v : inspected) {
    auto frame = sequence.read_view(v);
    if (!frame.ok()) return frame.error();
    if (all.views.empty()) {
      all.camera = frame->camera;
      all.contour_divisor = static_cast<int>(std::lround(all.pixel_scale()));
    }
    all.views.push_back(measure_view(v, *frame, all.contour_divisor, options.num_threads,
                                     all.half_shifts[all.views.size() % 2], views));
    if (!std::isnan(all.views.back().depth.median_m)) medians_m.push_back(all.views.back().depth.median_m);
    views.frames.emplace(v, std::move(frame).value());
  }
  all.depth_unit_m = upper_median(std::move(medians_m));
  if (!is_usable(all)) return all;
  inspection::DepthOfViews depths_m;
  for (const auto& [v, frame] : views.frames) depths_m.emplace(v, frame.depth_m);
  if (auto shift = find_unregistered_shift(all.half_shifts)) {
    shift->shift_px *= all.contour_divisor;
    for (auto& [v, frame] : views.frames) align_colors(*shift, frame);
  }
  FeaturesOfViews features;
  for (auto& [v, frame] : views.frames)
    if (is_similar(frame.camera, all.camera))
      features.emplace(v, extract_view_features(std::move(frame), all.depth_unit_m, options.num_threads));
  all.num_other_views = static_cast<int>(views.frames.size() - features.size());
  all.num_tried_pairs = static_cast<int>(pairs.size());
  all.pairs = match_pairs(pairs, features, all.camera);
  if (all.pairs.empty()) return all;
  all.depth_time =
      measure_depth_time(views.contours, all.pairs, reduce_camera(all.camera, all.contour_divisor), all.depth_unit_m);
  all.far_pairs = match_pairs(choose_far_pairs(inspected, all.num_views), features, all.camera);
  if (is_slow(all)) all.pairs = std::exchange(all.far_pairs, {});
  all.still_share = measure_still_share(all, depths_m);
  const auto error_of = [](const ViewPair& pair) { return pair.error_px; };
  all.pair_error_px = median_over(all.pairs, error_of);
  all.far_pair_error_px = median_over(all.far_pairs, error_of);
  all.pair_shift_px = median_over(all.pairs, median_shift_px);
  all.intrinsics = fit_intrinsics(all.pairs, all.camera);
  if (!sequence.has_poses()) return all;
  const auto poses = read_poses(sequence);
  if (!poses.ok()) return poses.error();
  inspection::mark_changed_pairs(*poses, depths_m, all);
  all.poses = measure_poses(*poses, all);
  return all;
}

}  // namespace resight
