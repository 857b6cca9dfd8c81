// SPDX-License-Identifier: Apache-2.0
#include "resight/cameras/internal/join_views.hpp"

#include <algorithm>
#include <utility>

namespace resight {
namespace {

// Uncertainty of a pose from features alone. Its information is added to that of the surfaces, which may leave
// directions unconstrained.
constexpr double kFeatureSigma_m = 0.01;
constexpr double kFeatureSigma_rad = 0.015;
// Residual error of calibration and time stamps between any two views, independent of the number of agreeing pixels.
constexpr double kFloorSigma_m = 0.003;
constexpr double kFloorSigma_rad = 0.003;

TwistMatrix feature_information() { return twist_information(kFeatureSigma_rad, kFeatureSigma_m); }

// Between views far apart, exposure and gloss change the brightness: it decides only where few matches agree.
bool agrees_with_matches(const TrackViewsOptions& options, const AlignedView& aligned, int num_matches) {
  return fits(options, aligned, options.plausible.min_overlap) &&
         (num_matches > options.few_matches.max_matches ||
          aligned.brightness_correlation >= options.few_matches.min_correlation);
}

}  // namespace

bool fits(const TrackViewsOptions& options, const AlignedView& aligned, double min_overlap) {
  return aligned.num_pairs > 0 && aligned.overlap >= min_overlap &&
         aligned.seen_through <= options.plausible.max_seen_through * std::min(1.0, 2 * aligned.overlap);
}

// Where no matches support a pose, the brightness must.
bool is_plausible(const TrackViewsOptions& options, const AlignedView& aligned) {
  return fits(options, aligned, options.plausible.min_overlap) &&
         !(aligned.brightness_correlation < options.plausible.min_correlation);
}

TwistMatrix edge_information(const TwistMatrix& information) {
  return limit_information(information, 1e-3, kFloorSigma_rad, kFloorSigma_m);
}

std::optional<KeyframeJoin> join_by_features(const TrackState& state, std::size_t keyframe, const AlignmentView& view,
                                             const ViewFeatures& features, int num_threads) {
  const Keyframe& k = state.keyframes[keyframe];
  const std::optional<ViewMatch> match = match_views(k.features, features, state.options.match);
  if (!match) return std::nullopt;
  AlignViewOptions align = state.options.align;
  align.num_threads = num_threads;
  align.prior_sigma_m = kFeatureSigma_m;
  align.prior_sigma_rad = kFeatureSigma_rad;
  const std::vector<AlignmentTarget> targets{{&k.alignment, state.pose_of(k)}};
  KeyframeJoin join{static_cast<int>(keyframe), align_view(view, targets, state.pose_of(k) * match->a_from_b, align),
                    match->num_inliers};
  join.information = join.aligned.information + feature_information();
  if (!agrees_with_matches(state.options, join.aligned, match->num_inliers)) return std::nullopt;
  const std::vector<AlignmentTarget> back{{&view, join.aligned.world_from_camera}};
  if (!agrees_with_matches(state.options, evaluate_alignment(k.alignment, back, state.pose_of(k), align),
                           match->num_inliers))
    return std::nullopt;
  return join;
}

}  // namespace resight
