// SPDX-License-Identifier: Apache-2.0
#include "resight/evaluation/change_points.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "resight/core/check.hpp"
#include "resight/evidence/surface_evidence.hpp"
#include "resight/geometry/kd_tree.hpp"

namespace resight {
namespace {

constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();

double ratio(long part, long whole) {
  return whole == 0 ? kNotANumber : static_cast<double>(part) / static_cast<double>(whole);
}

// Measured depth minus the depth of the point, along z; NaN without measurement.
double depth_behind(const RgbdFrame& frame, const Eigen::Vector3d& p_in_world) {
  const Eigen::Vector3d p = frame.world_from_camera.inverse() * p_in_world;
  return nearest_depth(p.cast<float>(), {frame.camera, frame.depth_m}, 0) - p.z();
}

}  // namespace

double ChangePointScore::precision() const { return ratio(right, reported); }
double ChangePointScore::recall() const { return ratio(found, expected); }

ChangePointScore& ChangePointScore::operator+=(const ChangePointScore& other) {
  reported += other.reported;
  right += other.right;
  expected += other.expected;
  found += other.found;
  return *this;
}

void ScoreChangePointsOptions::check() const {
  check_positive("ScoreChangePointsOptions.near_m", near_m);
  check_positive("ScoreChangePointsOptions.consistent_m", consistent_m);
  check_positive("ScoreChangePointsOptions.seen_through_m", seen_through_m);
  check_positive("ScoreChangePointsOptions.sample_m", sample_m);
  check_in_range("ScoreChangePointsOptions.min_points", min_points, 1, 1000000);
}

// An object's surface: dense for nearest-point queries, downsampled for the expected points.
struct ChangePointScorer::Surface {
  Surface(const PointCloud& cloud, double sample_m) : tree(cloud.points) {
    PointCloud bare;
    bare.points = cloud.points;
    samples = voxel_downsample(bare, sample_m).points;
    for (const auto& p : cloud.points) radius_m = std::max(radius_m, static_cast<double>(p.norm()));
  }
  KdTree tree;
  std::vector<Eigen::Vector3f> samples;
  double radius_m = 0;  // About the origin.
};

// A place that an object left or took before `view`.
struct ChangePointScorer::Place {
  int view = 0;
  bool has_left = true;
  Rigid3 world_from_object;
  const Surface* surface = nullptr;
  bool is_counted = false;
};

ChangePointScorer::ChangePointScorer(const ModelLibrary& library, const SequenceTruth& truth, int num_previous_views,
                                     const ScoreChangePointsOptions& options)
    : num_previous_views_(num_previous_views), options_(options) {
  options_.check();
  require(truth.changes.has_value(), "ChangePointScorer: the truth has no changes");
  for (const TrueChange& change : *truth.changes) {
    const int object = library.find(change.object);
    const auto unknown = truth.unknown_surfaces.find(change.object);
    if (object < 0 && unknown == truth.unknown_surfaces.end()) continue;
    const PointCloud& surface =
        object >= 0 ? library.objects[static_cast<std::size_t>(object)].surface : unknown->second;
    if (change.world_from_object_before) add_place(change, *change.world_from_object_before, surface, true);
    if (change.world_from_object_after) add_place(change, *change.world_from_object_after, surface, false);
  }
}

ChangePointScorer::~ChangePointScorer() = default;

void ChangePointScorer::add_place(const TrueChange& change, const Rigid3& world_from_object, const PointCloud& surface,
                                  bool has_left) {
  auto& stored = surfaces_[change.object];
  if (!stored) stored = std::make_unique<Surface>(surface, options_.sample_m);
  places_.push_back({change.view, has_left, world_from_object, stored.get(), false});
}

ChangePointScores ChangePointScorer::add_view(const RgbdFrame& frame, const PointCloud& removed_in_world,
                                              const PointCloud& novel_in_world) {
  ChangePointScores scores;
  score_reported(removed_in_world, true, scores.removed);
  score_reported(novel_in_world, false, scores.novel);
  score_expected(frame, removed_in_world, true, scores.removed);
  score_expected(frame, novel_in_world, false, scores.novel);
  window_.push_back(frame);
  window_.back().color = {};
  while (static_cast<int>(window_.size()) > num_previous_views_) window_.pop_front();
  ++view_;
  return scores;
}

void ChangePointScorer::score_reported(const PointCloud& reported_in_world, bool has_left,
                                       ChangePointScore& score) const {
  const auto near_sq = static_cast<float>(options_.near_m * options_.near_m);
  std::vector<std::pair<const Surface*, Rigid3>> candidates;
  for (const Place& place : places_)
    if (place.has_left == has_left && place.view <= view_)
      candidates.emplace_back(place.surface, place.world_from_object.inverse());
  score.reported += static_cast<long>(reported_in_world.size());
  for (const Eigen::Vector3f& p_in_world : reported_in_world.points) {
    const bool is_right = std::ranges::any_of(candidates, [&](const auto& candidate) {
      const Eigen::Vector3d p = candidate.second * p_in_world.cast<double>().eval();
      if (p.norm() > candidate.first->radius_m + options_.near_m) return false;
      return candidate.first->tree.nearest(p.cast<float>()).distance_sq <= near_sq;
    });
    score.right += is_right ? 1 : 0;
  }
}

void ChangePointScorer::score_expected(const RgbdFrame& frame, const PointCloud& reported_in_world, bool has_left,
                                       ChangePointScore& score) {
  const KdTree reported(reported_in_world.points);
  const auto near_sq = static_cast<float>(options_.near_m * options_.near_m);
  // The view number of window_[i] is view_ - window_.size() + i.
  const int first = view_ - static_cast<int>(window_.size());
  for (Place& place : places_) {
    if (place.has_left != has_left || place.view > view_ || place.is_counted) continue;
    ChangePointScore of_place;
    for (const Eigen::Vector3f& sample : place.surface->samples) {
      const Eigen::Vector3d p = place.world_from_object * sample.cast<double>().eval();
      const auto measured = [&](const RgbdFrame& f) { return std::abs(depth_behind(f, p)) <= options_.consistent_m; };
      const auto seen_through = [&](const RgbdFrame& f) { return depth_behind(f, p) > options_.seen_through_m; };
      if (!(has_left ? seen_through(frame) : measured(frame))) continue;
      bool was_other = false;
      for (int i = 0; i < static_cast<int>(window_.size()) && first + i < place.view && !was_other; ++i) {
        const RgbdFrame& earlier = window_[static_cast<std::size_t>(i)];
        was_other = has_left ? measured(earlier) : seen_through(earlier);
      }
      if (!was_other) continue;
      ++of_place.expected;
      const PointNeighbor nearest = reported.nearest(p.cast<float>());
      of_place.found += nearest.index >= 0 && nearest.distance_sq <= near_sq ? 1 : 0;
    }
    if (of_place.expected < options_.min_points) continue;
    place.is_counted = true;
    score += of_place;
  }
}

}  // namespace resight
