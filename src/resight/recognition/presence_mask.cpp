// SPDX-License-Identifier: Apache-2.0
#include "resight/recognition/presence_mask.hpp"

#include <Eigen/Geometry>
#include <algorithm>

#include "resight/core/parallel.hpp"

namespace resight {
namespace {

enum class PlaceEvent : std::uint8_t { kNone, kRemoved, kAppeared };

// The clusters of the points that a view found removed, or novel: made once for all hypotheses.
class ChangedPoints {
 public:
  ChangedPoints() = default;
  ChangedPoints(const PointCloud& in_world, const RemovalSupportOptions& options)
      : in_world_(&in_world),
        clusters_(cluster_points(in_world.points, options.cluster_distance_m, options.min_cluster_points)) {
    for (const std::vector<int>& cluster : clusters_) {
      Eigen::AlignedBox3f& box = boxes_.emplace_back();
      for (const int i : cluster) box.extend(in_world.points[static_cast<std::size_t>(i)]);
    }
  }

  // Most changes are far from most hypotheses: a look at the bounding sphere leaves few clusters.
  [[nodiscard]] int support(const PointCloud& surface_in_world, const Eigen::Vector3f& center, float radius_m,
                            const RemovalSupportOptions& options) const {
    std::vector<std::vector<int>> near;
    for (std::size_t c = 0; c < clusters_.size(); ++c)
      if (boxes_[c].squaredExteriorDistance(center) <= radius_m * radius_m) near.push_back(clusters_[c]);
    return near.empty() ? 0 : count_removal_support(surface_in_world, *in_world_, near, options);
  }

 private:
  const PointCloud* in_world_ = nullptr;
  std::vector<std::vector<int>> clusters_;
  std::vector<Eigen::AlignedBox3f> boxes_;
};

struct ClusteredChanges {
  int view = 0;
  ChangedPoints removed;
  ChangedPoints novel;
};

std::vector<ClusteredChanges> cluster_changes(std::span<const ViewChanges> window, const RemovalSupportOptions& options,
                                              int num_threads) {
  std::vector<ClusteredChanges> clustered(window.size());
  parallel_for(window.size(), num_threads, [&](std::size_t v) {
    clustered[v].view = window[v].view;
    if (window[v].removed_in_world != nullptr) clustered[v].removed = {*window[v].removed_in_world, options};
    if (window[v].novel_in_world != nullptr) clustered[v].novel = {*window[v].novel_in_world, options};
  });
  return clustered;
}

PlaceEvent find_event(const Hypothesis& hypothesis, const ClusteredChanges& changes, const PointCloud& surface_in_world,
                      const Eigen::Vector3f& center, float radius_m, const RemovalSupportOptions& options) {
  const int removed = changes.removed.support(surface_in_world, center, radius_m, options);
  const int novel = changes.novel.support(surface_in_world, center, radius_m, options);
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
  if (hypotheses.empty()) return mask;
  const std::vector<ClusteredChanges> clustered = cluster_changes(window, options, num_threads);
  parallel_for(hypotheses.size(), num_threads, [&](std::size_t h) {
    const ObjectModel& model = library.objects[static_cast<std::size_t>(hypotheses[h].object)];
    const PointCloud surface_in_world = transform(hypotheses[h].world_from_object, model.surface);
    const Eigen::Vector3f center = Rigid3f(hypotheses[h].world_from_object) * model.center;
    // The diameter bounds the distance of every surface point from the centroid.
    const float radius_m = model.diameter_m + static_cast<float>(options.model_distance_m);
    std::vector<PlaceEvent> events;
    for (const ClusteredChanges& changes : clustered)
      events.push_back(find_event(hypotheses[h], changes, surface_in_world, center, radius_m, options));
    fill_mask(events, h, hypotheses.size(), mask);
  });
  return mask;
}

}  // namespace resight
