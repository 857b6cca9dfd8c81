// SPDX-License-Identifier: Apache-2.0
#include "resight/recognition/presence_mask.hpp"

#include <algorithm>

#include "resight/core/parallel.hpp"

namespace resight {
namespace {

enum class PlaceEvent : std::uint8_t { kNone, kRemoved, kAppeared };

// Most changes are far from most hypotheses: a look at the bounding sphere saves the clustering.
bool touches(const PointCloud& changed, const Eigen::Vector3f& center, float radius_m) {
  const float radius_sq = radius_m * radius_m;
  return std::any_of(changed.points.begin(), changed.points.end(),
                     [&](const Eigen::Vector3f& p) { return (p - center).squaredNorm() <= radius_sq; });
}

int support(const PointCloud* changed, const PointCloud& surface_in_world, const Eigen::Vector3f& center,
            float radius_m, const RemovalSupportOptions& options) {
  if (changed == nullptr || !touches(*changed, center, radius_m)) return 0;
  return count_removal_support(surface_in_world, *changed, options);
}

PlaceEvent find_event(const Hypothesis& hypothesis, const ViewChanges& changes, const PointCloud& surface_in_world,
                      const Eigen::Vector3f& center, float radius_m, const RemovalSupportOptions& options) {
  const int removed = support(changes.removed_in_world, surface_in_world, center, radius_m, options);
  const int novel = support(changes.novel_in_world, surface_in_world, center, radius_m, options);
  const bool is_removed = removed > options.min_support_points && hypothesis.origin_view < changes.view;
  const bool is_novel = novel > options.min_support_points;
  if (is_novel && (!is_removed || novel >= removed)) return PlaceEvent::kAppeared;
  return is_removed ? PlaceEvent::kRemoved : PlaceEvent::kNone;
}

void fill_mask(std::span<const PlaceEvent> events, std::size_t hypothesis, std::size_t num_hypotheses,
               std::vector<std::uint8_t>& mask) {
  const auto first = std::find_if(events.begin(), events.end(), [](PlaceEvent e) { return e != PlaceEvent::kNone; });
  bool present = first == events.end() || *first != PlaceEvent::kAppeared;
  for (std::size_t v = 0; v < events.size(); ++v) {
    if (events[v] != PlaceEvent::kNone) present = events[v] == PlaceEvent::kAppeared;
    mask[v * num_hypotheses + hypothesis] = present ? 1 : 0;
  }
}

}  // namespace

std::vector<std::uint8_t> compute_presence_mask(std::span<const Hypothesis> hypotheses, const ModelLibrary& library,
                                                std::span<const ViewChanges> window,
                                                const RemovalSupportOptions& options, int num_threads) {
  options.check();
  std::vector<std::uint8_t> mask(window.size() * hypotheses.size(), 1);
  parallel_for(hypotheses.size(), num_threads, [&](std::size_t h) {
    const ObjectModel& model = library.objects[static_cast<std::size_t>(hypotheses[h].object)];
    const PointCloud surface_in_world = transform(hypotheses[h].world_from_object, model.surface);
    const Eigen::Vector3f center = Rigid3f(hypotheses[h].world_from_object) * model.center;
    // The diameter bounds the distance of every surface point from the centroid.
    const float radius_m = model.diameter_m + static_cast<float>(options.model_distance_m);
    std::vector<PlaceEvent> events;
    for (const ViewChanges& changes : window)
      events.push_back(find_event(hypotheses[h], changes, surface_in_world, center, radius_m, options));
    fill_mask(events, h, hypotheses.size(), mask);
  });
  return mask;
}

}  // namespace resight
