// SPDX-License-Identifier: Apache-2.0
#include "resight/recognition/competing_poses.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "resight/core/odds.hpp"
#include "resight/models/pose_distance.hpp"

namespace resight {
namespace {

constexpr SamePlaceOptions kOnePose{.max_distance_m = 0.05, .max_rotation_rad = 0.523599};  // 30 deg

// Of twins, one mesh under two names, the evidence differs by less than this: fit and similarities, and what they
// explain as a share.
constexpr double kTwinDifference = 0.01;

// Whether two hypotheses of different objects explain the same place equally well, so that only chance chose one.
bool are_twins(const HypothesisEvidence& a, const HypothesisEvidence& b) {
  const auto equal = [](double x, double y) { return std::abs(x - y) <= kTwinDifference; };
  return equal(a.fit, b.fit) && equal(a.appearance.pattern_similarity, b.appearance.pattern_similarity) &&
         equal(a.appearance.newest_similarity, b.appearance.newest_similarity) &&
         equal(a.appearance.hue_similarity, b.appearance.hue_similarity) &&
         equal(a.costs.explained_scene / b.costs.explained_scene, 1);
}

// Odds of the likeliest twin of each other object that the accepted hypothesis suppressed.
double odds_of_twins(const VerifiedHypotheses& verified, std::size_t accepted) {
  std::map<int, double> best;
  for (std::size_t h = 0; h < verified.hypotheses.size(); ++h) {
    const HypothesisEvidence& evidence = verified.evidence[h];
    if (verified.hypotheses[h].object == verified.hypotheses[accepted].object ||
        evidence.suppressed_by != static_cast<int>(accepted) || !are_twins(evidence, verified.evidence[accepted]))
      continue;
    double& odds = best[verified.hypotheses[h].object];
    odds = std::max(odds, odds_of(evidence.score));
  }
  double sum = 0;
  for (const auto& [object, odds] : best) sum += odds;
  return sum;
}

}  // namespace

PlaceScore score_place(const VerifiedHypotheses& verified, std::size_t accepted, const ModelLibrary& library) {
  const int object = verified.hypotheses[accepted].object;
  const ObjectModel& model = library.objects[static_cast<std::size_t>(object)];
  std::vector<const HypothesisEvidence*> candidates;
  for (std::size_t h = 0; h < verified.hypotheses.size(); ++h)
    if (verified.hypotheses[h].object == object && verified.evidence[h].suppressed_by == static_cast<int>(accepted))
      candidates.push_back(&verified.evidence[h]);
  std::ranges::stable_sort(candidates, std::ranges::greater(), &HypothesisEvidence::score);
  std::vector<const HypothesisEvidence*> distinct{&verified.evidence[accepted]};
  for (const HypothesisEvidence* candidate : candidates)
    if (std::ranges::none_of(distinct, [&](const HypothesisEvidence* other) {
          return is_same_place(model, candidate->world_from_object, other->world_from_object, kOnePose);
        }))
      distinct.push_back(candidate);
  double sum = odds_of_twins(verified, accepted);
  if (distinct.size() == 1 && sum == 0) return {distinct.front()->score, 1};
  for (const HypothesisEvidence* pose : distinct) sum += odds_of(pose->score);
  return {sum / (1 + sum), sum > 0 ? odds_of(distinct.front()->score) / sum : 1};
}

}  // namespace resight
