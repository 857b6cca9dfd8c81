// SPDX-License-Identifier: Apache-2.0
#include "resight/cameras/internal/join_views.hpp"

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

namespace resight {
namespace {

// Uncertainty of a pose from features alone. Its information is added to that of the surfaces, which may leave
// directions unconstrained.
constexpr double kFeatureSigma_m = 0.01;
constexpr double kFeatureSigma_rad = 0.015;
// Residual error of calibration and time stamps between any two views, independent of the number of agreeing pixels.
constexpr double kFloorSigma_m = 0.003;
constexpr double kFloorSigma_rad = 0.003;
// Up to this number, matches may agree by chance or on things that recur, and the brightness must not disagree.
constexpr int kMaxChanceMatches = 20;
// Of the blocks of the image, true joins have up to 0.22 dissimilar ones if the depth is registered to the colours, and
// twins 0.31 and more. Blocks that are dissimilar because colours lie beside the depth mostly have as many matches as
// others.
constexpr double kMaxDissimilar = 0.27;
constexpr double kMinMatchRatio = 0.5;  // Of the matches in dissimilar blocks over what their share in blocks predicts.

TwistMatrix feature_information() { return twist_information(kFeatureSigma_rad, kFeatureSigma_m); }

// Between views far apart, exposure and gloss change the brightness: it decides only where few matches agree.
bool agrees_with_matches(const TrackViewsOptions& options, const AlignedView& aligned, int num_matches) {
  const bool is_similar = aligned.brightness_correlation >= options.few_matches.min_correlation;
  return fits(options, aligned, options.plausible.min_overlap) &&
         (num_matches > options.few_matches.max_matches || is_similar) &&
         (num_matches > kMaxChanceMatches || is_plausible(options, aligned));
}

// Whether the matches are all on a thing that has a twin elsewhere: the surroundings differ, and have no match.
bool are_on_twin(std::span<const Eigen::Vector3f> matches, const AlignmentView& view, const AlignmentTarget& target,
                 const Rigid3& world_from_camera, const AlignViewOptions& align) {
  const Image<BlockSimilarity> blocks = compare_blocks(view, target, world_from_camera, align);
  const Camera& camera = view.levels[0].camera;
  std::vector<BlockSimilarity> with_match;
  for (const Eigen::Vector3f& point : matches)
    if (const std::optional<Pixel> pixel = camera.pixel_of(point.cast<double>()))
      with_match.push_back(
          blocks(pixel->u * blocks.width() / camera.width, pixel->v * blocks.height() / camera.height));
  const auto dissimilar_share = [](std::span<const BlockSimilarity> some) {
    const auto num_dissimilar = static_cast<double>(std::ranges::count(some, BlockSimilarity::kDissimilar));
    const auto num_similar = static_cast<double>(std::ranges::count(some, BlockSimilarity::kSimilar));
    return num_dissimilar / std::max(1.0, num_dissimilar + num_similar);
  };
  const double share = dissimilar_share(blocks.data());
  return share > kMaxDissimilar && dissimilar_share(with_match) < kMinMatchRatio * share;
}

}  // namespace

bool fits(const TrackViewsOptions& options, const AlignedView& aligned, double min_overlap) {
  return aligned.num_pairs > 0 && aligned.overlap >= min_overlap &&
         aligned.seen_through <= options.plausible.max_seen_through * std::min(1.0, 2 * aligned.overlap);
}

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
  if (are_on_twin(match->points_b, view, targets[0], join.aligned.world_from_camera, align) ||
      are_on_twin(match->points_a, k.alignment, back[0], state.pose_of(k), align))
    return std::nullopt;
  return join;
}

}  // namespace resight
