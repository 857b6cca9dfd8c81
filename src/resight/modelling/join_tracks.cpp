// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

#include "resight/core/parallel.hpp"
#include "resight/modelling/internal/track_view.hpp"

namespace resight {
namespace {

using Eigen::Vector3d;

// Ways to put the second recording's object frame into the first's that are one.
constexpr double kSameShiftM = 0.02;
constexpr double kSameTurnRad = 0.2;
constexpr int kMaxWays = 4;           // that are tried on the model
constexpr int kMaxMatchedViews = 18;  // of each recording
constexpr int kRefineRounds = 3;

struct Way {
  Rigid3 first_from_second;
  int num_matches = 0;
};

bool are_one(const Rigid3& a, const Rigid3& b, const Vector3d& middle) {
  return rotation_angle_rad(a.rotation, b.rotation) <= kSameTurnRad && (a * middle - b * middle).norm() <= kSameShiftM;
}

// About `count` of them, evenly.
std::vector<std::size_t> choose_evenly(std::size_t size, int count) {
  std::vector<std::size_t> chosen;
  const auto wanted = std::min(size, static_cast<std::size_t>(count));
  for (std::size_t k = 0; k < wanted; ++k) chosen.push_back(k * size / wanted);
  return chosen;
}

class TrackJoiner {
 public:
  TrackJoiner(ObjectTrack& first, ObjectTrack& second, const TrackObjectOptions& options)
      : first_(first.views), second_(second.views), options_(options) {
    FuseViewsOptions fuse = options.fuse;
    fuse.num_threads = options.num_threads;
    TriangleMesh mesh = fuse_views(first_, fuse);
    const TriangleMesh other = fuse_views(second_, fuse);
    for (const Eigen::Vector3f& p : other.vertices)
      middle_ += p.cast<double>() / static_cast<double>(other.vertices.size());
    if (!mesh.empty()) model_ = std::make_unique<ModelTarget>(std::move(mesh), options);
  }

  Result<Rigid3> find() {
    const std::vector<Way> ways = find_ways();
    std::optional<Rigid3> best;
    double best_score = 0;
    double best_overlap = 0;
    if (model_)
      for (const Way& way : ways) {
        const auto [pose, overlap, score, likeness] = refine(way.first_from_second);
        if (likeness < options_.min_correlation || (best && score <= best_score)) continue;
        best = pose;
        best_score = score;
        best_overlap = overlap;
      }
    if (!best || best_overlap < options_.min_join_overlap)
      return Error{fmt::format("the recordings cannot be joined: {} matches at best, {:.0f} % of the views in common",
                               ways.empty() ? 0 : ways.front().num_matches, 100 * best_overlap)};
    return *best;
  }

 private:
  // Features of views of both, each pair with a common pose; those that mean the same added up.
  std::vector<Way> find_ways() {
    const std::vector<std::size_t> of_first = choose_evenly(first_.size(), kMaxMatchedViews);
    const std::vector<std::size_t> of_second = choose_evenly(second_.size(), kMaxMatchedViews);
    const std::vector<TrackView> a = cut_out(first_, of_first);
    const std::vector<TrackView> b = cut_out(second_, of_second);
    std::vector<std::optional<Way>> found(a.size() * b.size());
    parallel_for(found.size(), options_.num_threads, [&](std::size_t k) {
      const std::size_t i = k / b.size();
      const std::size_t j = k % b.size();
      const std::optional<ViewMatch> match = match_views(a[i].features, b[j].features, options_.match);
      if (!match) return;
      found[k] = Way{first_[of_first[i]].frame.world_from_camera * match->a_from_b *
                         second_[of_second[j]].frame.world_from_camera.inverse(),
                     match->num_inliers};
    });
    return add_up(found);
  }

  [[nodiscard]] std::vector<TrackView> cut_out(const std::vector<TrainingView>& views,
                                               const std::vector<std::size_t>& chosen) const {
    std::vector<std::optional<TrackView>> parts(chosen.size());
    parallel_for(parts.size(), options_.num_threads,
                 [&](std::size_t k) { parts[k].emplace(make_track_view(views[chosen[k]], options_)); });
    std::vector<TrackView> result;
    for (std::optional<TrackView>& part : parts) result.push_back(std::move(*part));
    return result;
  }

  // The best supported first; what is one with a better one is left out.
  [[nodiscard]] std::vector<Way> add_up(const std::vector<std::optional<Way>>& found) const {
    std::vector<Way> sums;
    for (const auto& way : found) {
      if (!way) continue;
      Way sum{way->first_from_second, 0};
      for (const auto& other : found)
        if (other && are_one(way->first_from_second, other->first_from_second, middle_))
          sum.num_matches += other->num_matches;
      sums.push_back(sum);
    }
    std::ranges::stable_sort(sums, std::greater{}, &Way::num_matches);
    std::vector<Way> ways;
    for (const Way& way : sums) {
      const bool is_known = std::ranges::any_of(
          ways, [&](const Way& w) { return are_one(w.first_from_second, way.first_from_second, middle_); });
      if (!is_known && static_cast<int>(ways.size()) < kMaxWays) ways.push_back(way);
    }
    return ways;
  }

  struct Refined {
    Rigid3 pose;
    double overlap = 0;
    double score = 0;
    double likeness = 0;  // of brightness
  };

  // Each of some views of the second is aligned to the model; the way most like all of theirs is taken, and again.
  Refined refine(Rigid3 way) {
    Refined refined;
    for (int round = 0; round < kRefineRounds; ++round) {
      const std::vector<std::size_t> chosen = choose_evenly(second_.size(), options_.num_join_views);
      std::vector<AlignedView> aligned(chosen.size());
      parallel_for(chosen.size(), options_.num_threads, [&](std::size_t k) { aligned[k] = align(chosen[k], way); });
      refined = {way, 0, 0, 0};
      std::vector<Way> ways;
      for (std::size_t k = 0; k < chosen.size(); ++k) {
        const AlignedView& a = aligned[k];
        const double likeness = std::isnan(a.brightness_correlation) ? 0 : a.brightness_correlation;
        refined.overlap += a.overlap / static_cast<double>(chosen.size());
        // Of a flat thing both recordings share the rim only: prints that agree tell more than much in common.
        refined.score +=
            (std::min(a.overlap, 0.3) - 2 * a.seen_through + 2 * likeness) / static_cast<double>(chosen.size());
        refined.likeness += likeness / static_cast<double>(chosen.size());
        if (a.overlap >= options_.min_join_overlap)
          ways.push_back({a.world_from_camera * second_[chosen[k]].frame.world_from_camera.inverse(), a.num_pairs});
      }
      if (ways.empty()) break;
      way = find_medoid(ways);
    }
    refined.pose = way;
    return refined;
  }

  [[nodiscard]] AlignedView align(std::size_t view, const Rigid3& way) const {
    TrainingView part = crop_for_tracking(second_[view]);
    const Rigid3 start = way * part.frame.world_from_camera;
    const Camera camera = part.frame.camera;
    const PreparedView prepared = prepare_view(std::move(part.frame));
    return model_->align(make_alignment_view(prepared, options_.view, &part.mask), camera, start, false);
  }

  [[nodiscard]] Rigid3 find_medoid(const std::vector<Way>& ways) const {
    const Way* best = nullptr;
    double least = 0;
    for (const Way& way : ways) {
      double sum = 0;
      for (const Way& other : ways)
        sum += (way.first_from_second * middle_ - other.first_from_second * middle_).norm() +
               0.05 * rotation_angle_rad(way.first_from_second.rotation, other.first_from_second.rotation);
      if (best != nullptr && sum >= least) continue;
      best = &way;
      least = sum;
    }
    return best->first_from_second;
  }

  std::vector<TrainingView>& first_;
  std::vector<TrainingView>& second_;
  const TrackObjectOptions& options_;
  std::unique_ptr<ModelTarget> model_;
  Vector3d middle_ = Vector3d::Zero();  // of the second's surface, in its frame
};

}  // namespace

Result<ObjectTrack> join_tracks(ObjectTrack first, ObjectTrack second, const TrackObjectOptions& options) {
  options.check();
  const Result<Rigid3> first_from_second = TrackJoiner(first, second, options).find();
  if (!first_from_second) return first_from_second.error();
  for (TrainingView& view : second.views)
    view.frame.world_from_camera = *first_from_second * view.frame.world_from_camera;
  ObjectTrack joined = std::move(first);
  std::ranges::move(second.views, std::back_inserter(joined.views));
  joined.num_loops += second.num_loops;
  joined.drift_m = std::fmax(joined.drift_m, second.drift_m);
  joined.closure_error_m = std::fmax(joined.closure_error_m, second.closure_error_m);
  refine_on_model(joined.views, options, options.num_refinements);
  return joined;
}

}  // namespace resight
