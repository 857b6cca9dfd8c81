// SPDX-License-Identifier: Apache-2.0
#include "found_objects.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "resight/evaluation/match_detections.hpp"
#include "resight/models/pose_distance.hpp"

namespace resight::bench {
namespace {

bool is_right(const StageInput& input, const PosedObject& posed, const GroundTruthObject& truth) {
  const ObjectModel& model = input.library.objects[static_cast<std::size_t>(posed.object)];
  return model.name == truth.object &&
         is_within(compare_poses(posed.camera_from_object, truth.camera_from_object, model), {});
}

}  // namespace

std::string rate_proposals(const StageInput& input, const std::vector<PosedObject>& posed) {
  if (input.objects.empty()) return fmt::format("{} hypotheses", posed.size());
  std::vector<std::uint8_t> right(posed.size(), 0);
  int num_objects = 0, num_found = 0;
  for (const GroundTruthObject& truth : input.objects) {
    if (truth.visible_share < MatchDetectionsOptions{}.min_visible_share) continue;
    bool is_found = false;
    for (std::size_t i = 0; i < posed.size(); ++i)
      if (is_right(input, posed[i], truth)) {
        is_found = true;
        right[i] = 1;
      }
    ++num_objects;
    num_found += is_found ? 1 : 0;
  }
  return fmt::format("{} of {} objects; {} hypotheses, {} of them right", num_found, num_objects, posed.size(),
                     std::count(right.begin(), right.end(), 1));
}

std::string rate_detections(const StageInput& input, const std::vector<PosedObject>& posed) {
  if (input.objects.empty()) return fmt::format("{} accepted", posed.size());
  std::vector<DetectedObject> detections;
  for (const PosedObject& p : posed)
    detections.push_back({input.library.objects[static_cast<std::size_t>(p.object)].name, p.camera_from_object, 1});
  const MatchDetectionsResult result = match_detections(input.objects, detections, input.library);
  const std::size_t num_right = result.matches.size();
  const std::size_t num_named = num_right + result.false_positives.size();
  const std::size_t num_true = num_right + result.false_negatives.size();
  return fmt::format("precision {} of {}, recall {} of {}", num_right, num_named, num_right, num_true);
}

}  // namespace resight::bench
