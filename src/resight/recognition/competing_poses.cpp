// SPDX-License-Identifier: Apache-2.0
#include "resight/recognition/competing_poses.hpp"

#include <algorithm>
#include <vector>

#include "resight/core/odds.hpp"
#include "resight/models/pose_distance.hpp"

namespace resight {
namespace {

constexpr SamePlaceOptions kOnePose{.max_distance_m = 0.05, .max_rotation_rad = 0.523599};  // 30 deg

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
  if (distinct.size() == 1) return {distinct.front()->score, 1};
  double sum = 0;
  for (const HypothesisEvidence* pose : distinct) sum += odds_of(pose->score);
  return {sum / (1 + sum), sum > 0 ? odds_of(distinct.front()->score) / sum : 1};
}

}  // namespace resight
