// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include "resight/core/parallel.hpp"
#include "resight/core/statistics.hpp"
#include "resight/evidence/surface_evidence.hpp"
#include "resight/modelling/internal/align_shapes.hpp"
#include "resight/modelling/internal/object_edges.hpp"

namespace resight {
namespace {

using Eigen::Vector3d;

// Two motions of the second recording's object frame into the first's count as one below these differences.
constexpr double kSameShift_m = 0.02;
constexpr double kSameRotation_rad = 0.2;
constexpr int kMaxCandidates = 4;     // Tried on the model.
constexpr int kMaxMatchedViews = 18;  // Per recording.
constexpr int kRefineRounds = 3;      // Each aligns the views and takes the medoid of the motions.
// Below this number of keypoints, shape alone decides.
constexpr std::size_t kFewKeypoints = 40;  // Median per view.
constexpr double kMinAgreement = 0.25;     // Least ShapeFit::agreement of an alignment by shape.
constexpr double kMaxContradicted = 0.06;  // Largest share of either surface in the free space of the other.
constexpr std::size_t kVertexStep = 13;    // Every 13th vertex is tested, for speed.
// A point contradicts a view if it lies this far in front of the observed surface.
constexpr double kFree_m = 0.008;

// How the recordings may be joined.
struct Candidate {
  Rigid3 first_from_second;
  int num_matches = 0;
  double shape_score = 0;
};

bool are_same_motion(const Rigid3& a, const Rigid3& b, const Vector3d& middle) {
  return rotation_angle_rad(a.rotation, b.rotation) <= kSameRotation_rad &&
         (a * middle - b * middle).norm() <= kSameShift_m;
}

// About `count` indices, evenly spaced.
std::vector<int> choose_evenly(std::size_t size, int count) {
  std::vector<int> chosen;
  const auto wanted = std::min(size, static_cast<std::size_t>(count));
  for (std::size_t k = 0; k < wanted; ++k) chosen.push_back(static_cast<int>(k * size / wanted));
  return chosen;
}

class TrackJoiner {
 public:
  TrackJoiner(ObjectTrack& first, ObjectTrack& second, const TrackObjectOptions& options)
      : first_(first.views), second_(second.views), options_(options) {
    FuseViewsOptions fuse = options.fuse;
    fuse.num_threads = options.num_threads;
    first_mesh_ = fuse_views(first_, fuse);
    second_mesh_ = fuse_views(second_, fuse);
    for (const Eigen::Vector3f& p : second_mesh_.vertices)
      middle_ += p.cast<double>() / static_cast<double>(second_mesh_.vertices.size());
    if (!first_mesh_.empty()) model_ = std::make_unique<ModelTarget>(first_mesh_, options);
  }

  // Joins by features, or by shape if features give no result.
  Result<Rigid3> find() {
    const std::vector<Candidate> matched = find_by_features();
    if (const std::optional<Rigid3> best = choose(matched, options_.plausible.min_correlation)) return *best;
    const bool has_texture = num_keypoints_ >= kFewKeypoints;
    const std::vector<Candidate> shaped = find_by_shape();
    if (const std::optional<Rigid3> best = choose(shaped, has_texture ? options_.plausible.min_correlation : -1))
      return *best;
    return Error{fmt::format(
        "the recordings cannot be joined: {} matches at best, {}", matched.empty() ? 0 : matched.front().num_matches,
        shaped.empty() ? "no common shape" : "and no alignment by shape that the texture supports")};
  }

 private:
  // Refines the candidates and returns the one that best explains the views of the second recording.
  std::optional<Rigid3> choose(const std::vector<Candidate>& candidates, double min_likeness) {
    std::optional<Rigid3> best;
    double best_score = 0;
    if (!model_) return best;
    for (const Candidate& candidate : candidates) {
      const auto [pose, overlap, score, likeness] = refine(candidate.first_from_second);
      if (likeness < min_likeness || overlap < options_.join.min_overlap) continue;
      if (best && score + candidate.shape_score <= best_score) continue;
      best = pose;
      best_score = score + candidate.shape_score;
    }
    return best;
  }

  // Alignments in which neither surface occupies free space of the other recording's views.
  std::vector<Candidate> find_by_shape() {
    std::vector<Candidate> candidates;
    for (const ShapeFit& fit : align_shapes(first_mesh_, second_mesh_, {.num_threads = options_.num_threads})) {
      const double contradicted = std::max(contradicted_share(second_mesh_, fit.fixed_from_moving, first_),
                                           contradicted_share(first_mesh_, fit.fixed_from_moving.inverse(), second_));
      if (fit.agreement >= kMinAgreement && contradicted <= kMaxContradicted)
        candidates.push_back({fit.fixed_from_moving, 0, fit.agreement - 2 * contradicted});
    }
    std::ranges::stable_sort(candidates, std::greater{}, &Candidate::shape_score);
    if (candidates.size() > kMaxCandidates) candidates.resize(kMaxCandidates);
    return candidates;
  }

  // Share of the surface's points in front of what the views observe there, over some of the views.
  [[nodiscard]] double contradicted_share(const TriangleMesh& mesh, const Rigid3& views_from_mesh,
                                          const std::vector<TrainingView>& views) const {
    std::vector<Eigen::Vector3f> sampled;
    for (std::size_t k = 0; k < mesh.vertices.size(); k += kVertexStep) sampled.push_back(mesh.vertices[k]);
    // Points at the outline fall on pixels beside it, too, where the view sees the background.
    const SurfaceEvidenceOptions evidence_options{.margin = {.base_m = kFree_m, .noise_sigmas = 0},
                                                  .window_radius_px = 1};
    int before = 0, seen = 0;
    for (const int v : choose_evenly(views.size(), options_.join.num_views)) {
      const RgbdFrame& frame = views[v].frame;
      const SurfaceEvidence evidence =
          classify_surface({.points = sampled}, frame.world_from_camera.inverse() * views_from_mesh,
                           {frame.camera, frame.depth_m}, evidence_options);
      before += evidence.num(Evidence::kSeenThrough);
      seen += static_cast<int>(sampled.size()) - evidence.num(Evidence::kUnobserved);
    }
    return seen == 0 ? 0 : static_cast<double>(before) / seen;
  }

  // Matches features between views of both recordings. Matches with similar motions are added up.
  std::vector<Candidate> find_by_features() {
    const std::vector<int> of_first = choose_evenly(first_.size(), kMaxMatchedViews);
    const std::vector<int> of_second = choose_evenly(second_.size(), kMaxMatchedViews);
    const std::vector<TrackView> a = make_track_views(first_, of_first, options_);
    const std::vector<TrackView> b = make_track_views(second_, of_second, options_);
    num_keypoints_ = std::min(median_keypoints(a), median_keypoints(b));
    std::vector<std::optional<Candidate>> found(a.size() * b.size());
    parallel_for(found.size(), options_.num_threads, [&](std::size_t k) {
      const std::size_t i = k / b.size();
      const std::size_t j = k % b.size();
      const std::optional<ViewMatch> match = match_views(a[i].features, b[j].features, options_.features.match);
      if (!match) return;
      found[k] = Candidate{first_[of_first[i]].frame.world_from_camera * match->a_from_b *
                               second_[of_second[j]].frame.world_from_camera.inverse(),
                           match->num_inliers};
    });
    return add_up(found);
  }

  [[nodiscard]] static std::size_t median_keypoints(const std::vector<TrackView>& views) {
    std::vector<std::size_t> numbers;
    for (const TrackView& view : views) numbers.push_back(view.features.features().size());
    return numbers.empty() ? 0 : upper_median(std::move(numbers));
  }

  // Sorted by support, without duplicates.
  [[nodiscard]] std::vector<Candidate> add_up(const std::vector<std::optional<Candidate>>& found) const {
    std::vector<Candidate> sums;
    for (const auto& candidate : found) {
      if (!candidate) continue;
      Candidate sum{candidate->first_from_second, 0};
      for (const auto& other : found)
        if (other && are_same_motion(candidate->first_from_second, other->first_from_second, middle_))
          sum.num_matches += other->num_matches;
      sums.push_back(sum);
    }
    std::ranges::stable_sort(sums, std::greater{}, &Candidate::num_matches);
    std::vector<Candidate> candidates;
    for (const Candidate& candidate : sums) {
      const bool is_known = std::ranges::any_of(candidates, [&](const Candidate& other) {
        return are_same_motion(other.first_from_second, candidate.first_from_second, middle_);
      });
      if (!is_known && static_cast<int>(candidates.size()) < kMaxCandidates) candidates.push_back(candidate);
    }
    return candidates;
  }

  struct Refined {
    Rigid3 pose;
    double overlap = 0;
    double score = 0;
    double likeness = 0;  // Brightness correlation.
  };

  // Aligns some views of the second recording to the model and takes the medoid of the resulting motions; repeated.
  Refined refine(Rigid3 first_from_second) {
    Refined refined;
    for (int round = 0; round < kRefineRounds; ++round) {
      const std::vector<int> chosen = choose_evenly(second_.size(), options_.join.num_views);
      std::vector<AlignedView> aligned(chosen.size());
      parallel_for(chosen.size(), options_.num_threads,
                   [&](std::size_t k) { aligned[k] = align(chosen[k], first_from_second); });
      refined = {first_from_second, 0, 0, 0};
      std::vector<Candidate> candidates;
      for (std::size_t k = 0; k < chosen.size(); ++k) {
        const AlignedView& a = aligned[k];
        const double likeness = std::isnan(a.brightness_correlation) ? 0 : a.brightness_correlation;
        refined.overlap += a.overlap / static_cast<double>(chosen.size());
        // Both recordings of a flat object share only its rim; matching texture is then more informative than a large
        // overlap.
        refined.score +=
            (std::min(a.overlap, 0.3) - 2 * a.seen_through + 2 * likeness) / static_cast<double>(chosen.size());
        refined.likeness += likeness / static_cast<double>(chosen.size());
        if (a.overlap >= options_.join.min_overlap)
          candidates.push_back(
              {a.world_from_camera * second_[chosen[k]].frame.world_from_camera.inverse(), a.num_pairs});
      }
      if (candidates.empty()) break;
      first_from_second = find_medoid(candidates);
    }
    refined.pose = first_from_second;
    return refined;
  }

  [[nodiscard]] AlignedView align(int view, const Rigid3& first_from_second) const {
    TrainingView part = crop_for_tracking(second_[view]);
    const Rigid3 start = first_from_second * part.frame.world_from_camera;
    const Camera camera = part.frame.camera;
    const PreparedView prepared = prepare_view(std::move(part.frame));
    return model_->align(make_alignment_view(prepared, options_.view, &part.mask), camera, start, false);
  }

  [[nodiscard]] Rigid3 find_medoid(const std::vector<Candidate>& candidates) const {
    const Candidate* best = nullptr;
    double least = 0;
    for (const Candidate& candidate : candidates) {
      double sum = 0;
      for (const Candidate& other : candidates)
        sum += (candidate.first_from_second * middle_ - other.first_from_second * middle_).norm() +
               0.05 * rotation_angle_rad(candidate.first_from_second.rotation, other.first_from_second.rotation);
      if (best != nullptr && sum >= least) continue;
      best = &candidate;
      least = sum;
    }
    return best->first_from_second;
  }

  std::vector<TrainingView>& first_;
  std::vector<TrainingView>& second_;
  const TrackObjectOptions& options_;
  TriangleMesh first_mesh_, second_mesh_;
  std::unique_ptr<ModelTarget> model_;
  std::size_t num_keypoints_ = 0;       // Per view, of the recording with fewer keypoints.
  Vector3d middle_ = Vector3d::Zero();  // Middle of the second surface, in its frame.
};

}  // namespace

Result<ObjectTrack> join_tracks(ObjectTrack first, ObjectTrack second, const TrackObjectOptions& options) {
  options.check();
  const Result<Rigid3> first_from_second = TrackJoiner(first, second, options).find();
  if (!first_from_second) return first_from_second.error();
  for (TrainingView& view : second.views)
    view.frame.world_from_camera = *first_from_second * view.frame.world_from_camera;
  ObjectTrack joined = std::move(first);
  const int num_first = static_cast<int>(joined.views.size());
  for (const auto& [a, b] : second.loops) joined.loops.emplace_back(num_first + a, num_first + b);
  std::ranges::move(second.views, std::back_inserter(joined.views));
  joined.drift_m = std::fmax(joined.drift_m, second.drift_m);
  refine_on_model(joined.views, options, options.num_refinements);
  joined.closure_error_m = measure_closure(joined.views, joined.loops, StartKind::kGuess, options);
  return joined;
}

}  // namespace resight
