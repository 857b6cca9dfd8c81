// SPDX-License-Identifier: Apache-2.0
#include "resight/inspection/measure_sequence.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "resight/core/statistics.hpp"
#include "resight/inspection/pose_readings.hpp"
#include "resight/sensor/color_offset.hpp"

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

ViewMeasurements measure_view(int number, const RgbdFrame& frame, int num_threads, ShiftScores& scores) {
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
  const PreparedView prepared = prepare_view(frame, options);
  scores.add(prepared);
  view.fine_shift_px = measure_color_offset(prepared);
  return view;
}

double median_shift_px(const ViewPair& pair) {
  std::vector<double> shifts_px;
  for (const MatchedPoint& m : pair.matches) shifts_px.push_back((m.pixel_a - m.pixel_b).norm());
  return upper_median(std::move(shifts_px));
}

/// Whether features can be found and projected.
bool is_usable(const SequenceMeasurements& all) {
  const Camera& c = all.camera;
  const auto is_focal = [&](double f) { return f > 0.05 * c.width && f < 50 * c.width; };
  return is_focal(c.fx) && is_focal(c.fy) && std::isfinite(all.depth_unit_m) && all.depth_unit_m > 0;
}

}  // namespace

Result<SequenceMeasurements> measure_sequence(const Sequence& sequence, const MeasureSequenceOptions& options) {
  SequenceMeasurements all;
  all.num_views = sequence.num_views();
  const auto pairs = choose_pairs(all.num_views, options.max_views);
  std::map<int, RgbdFrame> frames;
  std::vector<double> medians_m;
  for (const int v : views_of(pairs)) {
    auto frame = sequence.read_view(v);
    if (!frame.ok()) return frame.error();
    if (all.views.empty()) all.camera = frame->camera;
    all.views.push_back(measure_view(v, *frame, options.num_threads, all.half_shifts[all.views.size() % 2]));
    if (!std::isnan(all.views.back().depth.median_m)) medians_m.push_back(all.views.back().depth.median_m);
    frames.emplace(v, std::move(frame).value());
  }
  all.depth_unit_m = upper_median(std::move(medians_m));
  if (!is_usable(all)) return all;
  std::map<int, ViewFeatures> features;
  for (auto& [v, frame] : frames)
    if (frame.camera == all.camera)
      features.emplace(v, extract_view_features(std::move(frame), all.depth_unit_m, options.num_threads));
  std::vector<double> errors_px, shifts_px;
  for (const auto& [a, b] : pairs) {
    if (!features.contains(a) || !features.contains(b)) continue;
    ++all.num_tried_pairs;
    ViewPair pair = match_view_pair(a, features.at(a), b, features.at(b), all.camera);
    if (pair.matches.empty()) continue;
    errors_px.push_back(pair.error_px);
    shifts_px.push_back(median_shift_px(pair));
    all.pairs.push_back(std::move(pair));
  }
  if (all.pairs.empty()) return all;
  all.pair_error_px = upper_median(std::move(errors_px));
  all.pair_shift_px = upper_median(std::move(shifts_px));
  all.intrinsics = fit_intrinsics(all.pairs, all.camera);
  if (!sequence.has_poses()) return all;
  auto poses = measure_poses(sequence, all);
  if (!poses.ok()) return poses.error();
  all.poses = std::move(poses).value();
  return all;
}

}  // namespace resight
