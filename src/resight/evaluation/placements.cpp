// SPDX-License-Identifier: Apache-2.0
#include "resight/evaluation/placements.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "resight/core/check.hpp"

namespace resight {
namespace {

const GroundTruthObject* find_annotation(const TruthView& view, const std::string& object, int instance) {
  const auto found = std::ranges::find_if(
      view.objects, [&](const GroundTruthObject& o) { return o.object == object && o.instance == instance; });
  return found == view.objects.end() ? nullptr : &*found;
}

}  // namespace

Result<std::vector<AnnotatedPlacement>> locate_placements(const std::vector<ObjectPlacement>& placements,
                                                          std::span<const TruthView> views, const ModelLibrary& library,
                                                          std::string_view name) {
  std::vector<AnnotatedPlacement> located;
  for (const ObjectPlacement& placement : placements) {
    AnnotatedPlacement& place = located.emplace_back();
    place.object = placement.object;
    for (const auto& [view, instance] : placement.entries) {
      require(view >= 0 && view < static_cast<int>(views.size()), "locate_placements: a view does not exist");
      const TruthView& truth = views[static_cast<std::size_t>(view)];
      const GroundTruthObject* annotation = find_annotation(truth, placement.object, instance);
      if (annotation == nullptr)
        return Error{fmt::format("{}: view {} has no annotation of '{}' with instance {}", name, view, placement.object,
                                 instance)};
      place.last_view = view;
      place.last_world_from_object = truth.world_from_camera * annotation->camera_from_object;
      if (view != placement.entries.front().view) continue;
      place.first_view = view;
      place.first_world_from_object = place.last_world_from_object;
    }
  }
  std::erase_if(located, [&](const AnnotatedPlacement& p) { return library.find(p.object) < 0; });
  return located;
}

std::vector<FormerPlace> penalized_places(std::span<const AnnotatedPlacement> placements,
                                          std::span<const char> has_left, int num_views) {
  require(placements.size() == has_left.size(), "penalized_places: has_left must have one entry per placement");
  std::vector<FormerPlace> places;
  for (std::size_t i = 0; i < placements.size(); ++i) {
    const AnnotatedPlacement& p = placements[i];
    if (p.last_view + 1 < num_views)
      places.push_back({p.object, p.last_world_from_object, p.last_view, has_left[i] != 0});
  }
  return places;
}

}  // namespace resight
