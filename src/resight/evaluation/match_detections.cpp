// SPDX-License-Identifier: Apache-2.0
#include "resight/evaluation/match_detections.hpp"

#include <algorithm>
#include <limits>
#include <numbers>

#include "resight/core/check.hpp"
#include "resight/evaluation/assignment.hpp"

namespace resight {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

/// Library index of each name; -1 = not found.
template <typename Object>
std::vector<int> library_indices(std::span<const Object> objects, const ModelLibrary& library) {
  std::vector<int> indices;
  indices.reserve(objects.size());
  for (const Object& object : objects) indices.push_back(library.find(object.object));
  return indices;
}

std::vector<int> positions_of(int value, std::span<const int> values, std::span<const char> usable) {
  std::vector<int> positions;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (values[i] == value && usable[i]) positions.push_back(static_cast<int>(i));
  }
  return positions;
}

/// Ground truth and detections of one view during matching.
struct Matching {
  std::span<const GroundTruthObject> truth;
  std::span<const DetectedObject> detections;
  const MatchDetectionsOptions& options;
  std::vector<char> free_detections;

  /// Finds the best one-to-one pairs between the free detections and the given ground truth of one object, and removes
  /// the matched detections from the free ones.
  std::vector<DetectionMatch> pair_up(const ObjectModel& model, std::span<const int> detection_indices,
                                      std::span<const int> truth_indices) {
    std::vector<double> cost;
    std::vector<PoseDifference> differences;
    for (const int d : detection_indices) {
      for (const int t : truth_indices) {
        const PoseDifference difference = compare_poses(detections[static_cast<std::size_t>(d)].camera_from_object,
                                                        truth[static_cast<std::size_t>(t)].camera_from_object, model);
        differences.push_back(difference);
        cost.push_back(is_within(difference, options) ? difference.center_distance_m / options.max_center_distance_m +
                                                            difference.rotation_rad / options.max_rotation_rad
                                                      : std::numeric_limits<double>::quiet_NaN());
      }
    }
    const int num_truths = static_cast<int>(truth_indices.size());
    const std::vector<int> chosen = assign_optimally(cost, static_cast<int>(detection_indices.size()), num_truths);
    std::vector<DetectionMatch> matches;
    for (std::size_t row = 0; row < chosen.size(); ++row) {
      if (chosen[row] < 0) continue;
      const int detection = detection_indices[row];
      free_detections[static_cast<std::size_t>(detection)] = 0;
      matches.push_back(
          {detection, truth_indices[static_cast<std::size_t>(chosen[row])],
           differences[row * static_cast<std::size_t>(num_truths) + static_cast<std::size_t>(chosen[row])]});
    }
    return matches;
  }
};

void append_truth_lists(std::span<const int> truth_object, std::span<const char> visible, std::span<const char> found,
                        MatchDetectionsResult& result) {
  for (std::size_t t = 0; t < truth_object.size(); ++t) {
    const int index = static_cast<int>(t);
    if (truth_object[t] < 0) {
      result.unknown_truth.push_back(index);
    } else if (!visible[t]) {
      result.ignored_truth.push_back(index);
    } else if (!found[t]) {
      result.false_negatives.push_back(index);
    }
  }
}

}  // namespace

void MatchDetectionsOptions::check() const {
  check_positive("MatchDetectionsOptions.max_center_distance_m", max_center_distance_m);
  check_positive("MatchDetectionsOptions.max_rotation_rad", max_rotation_rad);
  check_in_range("MatchDetectionsOptions.min_visible_share", min_visible_share, 0.0, 1.0);
}

MatchDetectionsOptions strict_match_options() {
  return {.max_center_distance_m = 0.01, .max_rotation_rad = 10 * kDegree};
}

bool is_within(const PoseDifference& difference, const MatchDetectionsOptions& options) {
  return difference.center_distance_m <= options.max_center_distance_m &&
         difference.rotation_rad <= options.max_rotation_rad;
}

MatchDetectionsResult match_detections(std::span<const GroundTruthObject> truth,
                                       std::span<const DetectedObject> detections, const ModelLibrary& library,
                                       const MatchDetectionsOptions& options) {
  options.check();
  const std::vector<int> truth_object = library_indices(truth, library);
  const std::vector<int> detection_object = library_indices(detections, library);
  for (std::size_t d = 0; d < detections.size(); ++d) {
    require(detection_object[d] >= 0, "match_detections: no object '" + detections[d].object + "' in the library");
  }
  std::vector<char> visible(truth.size());
  std::vector<char> hidden(truth.size());
  for (std::size_t t = 0; t < truth.size(); ++t) {
    hidden[t] = truth[t].visible_share < options.min_visible_share ? 1 : 0;  // NaN is not known to be occluded.
    visible[t] = hidden[t] ? 0 : 1;
  }

  MatchDetectionsResult result;
  Matching matching{truth, detections, options, std::vector<char>(detections.size(), 1)};
  std::vector<char> found(truth.size(), 0);
  for (int object = 0; object < static_cast<int>(library.objects.size()); ++object) {
    const ObjectModel& model = library.objects[static_cast<std::size_t>(object)];
    // Visible truth first, so that an occluded one does not take the detection of one that counts.
    for (const DetectionMatch& match :
         matching.pair_up(model, positions_of(object, detection_object, matching.free_detections),
                          positions_of(object, truth_object, visible))) {
      found[static_cast<std::size_t>(match.truth)] = 1;
      result.matches.push_back(match);
    }
    for (const DetectionMatch& match :
         matching.pair_up(model, positions_of(object, detection_object, matching.free_detections),
                          positions_of(object, truth_object, hidden))) {
      result.ignored_detections.push_back(match.detection);
    }
  }
  std::sort(result.matches.begin(), result.matches.end(),
            [](const DetectionMatch& a, const DetectionMatch& b) { return a.detection < b.detection; });
  std::sort(result.ignored_detections.begin(), result.ignored_detections.end());
  for (std::size_t d = 0; d < detections.size(); ++d) {
    if (matching.free_detections[d]) result.false_positives.push_back(static_cast<int>(d));
  }
  append_truth_lists(truth_object, visible, found, result);
  result.score = {static_cast<int>(result.matches.size()), static_cast<int>(result.false_positives.size()),
                  static_cast<int>(result.false_negatives.size())};
  return result;
}

}  // namespace resight
