// SPDX-License-Identifier: Apache-2.0
#include "resight/evaluation/ghosts.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "resight/core/check.hpp"

namespace resight {
namespace {

const ObjectModel* find_model(const std::string& name, const ModelLibrary& library) {
  const int index = library.find(name);
  return index < 0 ? nullptr : &library.objects[static_cast<std::size_t>(index)];
}

/// The nearest placement of the observed object within the limits. Null: there is none, or this view has observed it.
FormerPlace* find_placement(std::vector<FormerPlace>& places, const FormerPlace& observed, const ObjectModel& model,
                            const MatchDetectionsOptions& limits) {
  FormerPlace* nearest = nullptr;
  double nearest_distance_m = std::numeric_limits<double>::infinity();
  for (FormerPlace& place : places) {
    if (place.object != observed.object || place.last_view == observed.last_view) continue;
    const PoseDifference difference = compare_poses(observed.world_from_object, place.world_from_object, model);
    if (!is_within(difference, limits) || difference.center_distance_m >= nearest_distance_m) continue;
    nearest = &place;
    nearest_distance_m = difference.center_distance_m;
  }
  return nearest;
}

bool is_explained_by_truth(const DetectedObject& detection, const std::vector<GroundTruthObject>& truth,
                           const ObjectModel& model, const MatchDetectionsOptions& options) {
  return std::any_of(truth.begin(), truth.end(), [&](const GroundTruthObject& object) {
    return object.object == detection.object &&
           is_within(compare_poses(detection.camera_from_object, object.camera_from_object, model), options);
  });
}

bool sees(const Camera& camera, const Rigid3& camera_from_object, const ObjectModel& model) {
  const Eigen::Vector3d center_in_camera = camera_from_object * Eigen::Vector3d(model.center.cast<double>());
  return camera.pixel_of(center_in_camera).has_value();
}

}  // namespace

std::vector<FormerPlace> find_former_places(std::span<const TruthView> views, const ModelLibrary& library,
                                            const MatchDetectionsOptions& limits) {
  limits.check();
  std::vector<FormerPlace> places;
  for (std::size_t view = 0; view < views.size(); ++view) {
    for (const GroundTruthObject& object : views[view].objects) {
      const ObjectModel* model = find_model(object.object, library);
      if (model == nullptr) continue;
      FormerPlace observed{object.object, views[view].world_from_camera * object.camera_from_object,
                           static_cast<int>(view)};
      FormerPlace* known = find_placement(places, observed, *model, limits);
      (known != nullptr ? *known : places.emplace_back()) = std::move(observed);
    }
  }
  std::erase_if(places,
                [&](const FormerPlace& place) { return place.last_view + 1 >= static_cast<int>(views.size()); });
  return places;
}

std::vector<Ghost> find_ghosts(std::span<const FormerPlace> places, const TruthView& truth, int view,
                               std::span<const DetectedObject> detections, const Camera& camera,
                               const ModelLibrary& library, const MatchDetectionsOptions& options) {
  options.check();
  require(camera.is_valid(), "find_ghosts: the camera is not valid");
  const Rigid3 camera_from_world = truth.world_from_camera.inverse();
  std::vector<Ghost> ghosts;
  for (std::size_t d = 0; d < detections.size(); ++d) {
    const ObjectModel* model = find_model(detections[d].object, library);
    require(model != nullptr, "find_ghosts: no object '" + detections[d].object + "' in the library");
    if (is_explained_by_truth(detections[d], truth.objects, *model, options)) continue;
    std::optional<Ghost> nearest;
    for (std::size_t p = 0; p < places.size(); ++p) {
      if (!places[p].is_proven || places[p].object != detections[d].object || places[p].last_view >= view) continue;
      const Rigid3 camera_from_object = camera_from_world * places[p].world_from_object;
      if (!sees(camera, camera_from_object, *model)) continue;
      const PoseDifference difference = compare_poses(detections[d].camera_from_object, camera_from_object, *model);
      if (!is_within(difference, options)) continue;
      if (!nearest || difference.center_distance_m < nearest->difference.center_distance_m) {
        nearest = Ghost{static_cast<int>(d), static_cast<int>(p), difference};
      }
    }
    if (nearest) ghosts.push_back(*nearest);
  }
  return ghosts;
}

int count_detected_former_places(std::span<const FormerPlace> places, const Rigid3& world_from_camera, int view,
                                 std::span<const DetectedObject> detections, const ModelLibrary& library,
                                 const MatchDetectionsOptions& options) {
  const Rigid3 camera_from_world = world_from_camera.inverse();
  std::vector<GroundTruthObject> former;
  for (const FormerPlace& place : places) {
    if (place.last_view >= view) continue;
    GroundTruthObject object;
    object.object = place.object;
    object.camera_from_object = camera_from_world * place.world_from_object;
    former.push_back(std::move(object));
  }
  return static_cast<int>(match_detections(former, detections, library, options).matches.size());
}

}  // namespace resight
