// SPDX-License-Identifier: Apache-2.0
#include "resight/cameras/object_places.hpp"

#include <algorithm>
#include <limits>

#include "resight/core/check.hpp"

namespace resight {
namespace {

Rigid3 component_from_object(const CameraTrack& track, const ObservedObject& o) {
  return track.views[static_cast<std::size_t>(o.view)].world_from_camera * o.camera_from_object;
}

// Pose of the observation whose centre is nearest to those of the others.
Rigid3 find_medoid(const CameraTrack& track, std::span<const ObservedObject> observed, const ObjectPlace& place,
                   const Eigen::Vector3d& center) {
  Rigid3 best;
  double least = std::numeric_limits<double>::infinity();
  for (const int i : place.observations) {
    const Rigid3 pose = component_from_object(track, observed[static_cast<std::size_t>(i)]);
    double sum = 0;
    for (const int j : place.observations)
      sum += (pose * center - component_from_object(track, observed[static_cast<std::size_t>(j)]) * center).norm();
    if (sum >= least) continue;
    least = sum;
    best = pose;
  }
  return best;
}

}  // namespace

std::vector<ObjectPlace> find_places(const CameraTrack& track, std::span<const ObservedObject> observed,
                                     const ModelLibrary& library, const SamePlaceOptions& options) {
  options.check();
  for (const ObservedObject& o : observed)
    require(o.view >= 0 && static_cast<std::size_t>(o.view) < track.views.size() && o.object >= 0 &&
                static_cast<std::size_t>(o.object) < library.objects.size(),
            "observed: must name views of the track and objects of the library");
  std::vector<ObjectPlace> places;
  for (std::size_t i = 0; i < observed.size(); ++i) {
    const ObservedObject& o = observed[i];
    const ObjectModel& model = library.objects[static_cast<std::size_t>(o.object)];
    const int component = track.views[static_cast<std::size_t>(o.view)].component;
    const Rigid3 pose = component_from_object(track, o);
    const auto place = std::ranges::find_if(places, [&](const ObjectPlace& p) {
      return p.object == o.object && p.component == component &&
             is_same_place(model, p.component_from_object, pose, options);
    });
    if (place != places.end())
      place->observations.push_back(static_cast<int>(i));
    else
      places.push_back({o.object, component, pose, {static_cast<int>(i)}});
  }
  for (ObjectPlace& place : places)
    place.component_from_object = find_medoid(
        track, observed, place, library.objects[static_cast<std::size_t>(place.object)].center.cast<double>());
  std::ranges::stable_sort(places, {}, &ObjectPlace::component);
  return places;
}

}  // namespace resight
