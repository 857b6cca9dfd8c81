// SPDX-License-Identifier: Apache-2.0
#include "resight/recognition/presence_mask.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <memory>
#include <optional>

#include "resight/core/parallel.hpp"

namespace resight {
namespace {

// Holds all of a hypothesis, and what is near to it.
struct BoundingSphere {
  Eigen::Vector3f center;
  float radius_m = 0;
};

// The diameter bounds the distance of every surface point from the centroid.
BoundingSphere bound(const ObjectModel& model, const Rigid3& world_from_object, const RemovalSupportOptions& options) {
  return {Rigid3f(world_from_object) * model.center, model.diameter_m + static_cast<float>(options.model_distance_m)};
}

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

  // Most changes are far from most hypotheses.
  [[nodiscard]] std::vector<std::vector<int>> near(const BoundingSphere& ball) const {
    std::vector<std::vector<int>> found;
    for (std::size_t c = 0; c < clusters_.size(); ++c)
      if (boxes_[c].squaredExteriorDistance(ball.center) <= ball.radius_m * ball.radius_m)
        found.push_back(clusters_[c]);
    return found;
  }
  [[nodiscard]] bool any_near(const BoundingSphere& ball) const {
    return std::ranges::any_of(boxes_, [&](const Eigen::AlignedBox3f& box) {
      return box.squaredExteriorDistance(ball.center) <= ball.radius_m * ball.radius_m;
    });
  }
  [[nodiscard]] const PointCloud& in_world() const { return *in_world_; }

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

bool any_near(const BoundingSphere& ball, const std::vector<ClusteredChanges>& changes) {
  return std::ranges::any_of(
      changes, [&](const ClusteredChanges& c) { return c.removed.any_near(ball) || c.novel.any_near(ball); });
}

// The place of a hypothesis that changes are near to, and the surface of its object.
struct Place {
  int origin_view = -1;
  const ProximityGrid& surface_in_object;
  BoundingSphere ball;
  Rigid3 object_from_world;
};

PlaceChange find_event(const Place& place, const ClusteredChanges& changes, const RemovalSupportOptions& options) {
  const auto support = [&](const ChangedPoints& points) {
    const std::vector<std::vector<int>> near = points.near(place.ball);
    if (near.empty()) return 0;
    return count_removal_support(place.surface_in_object, place.object_from_world, points.in_world(), near, options);
  };
  // Novel points outweigh removed ones: the object was pushed or turned a little, or another is in its place.
  // Verification in this view tells which.
  if (support(changes.novel) > options.min_support_points) return PlaceChange::kCame;
  const bool has_left = place.origin_view < changes.view && support(changes.removed) > options.min_support_points;
  return has_left ? PlaceChange::kLeft : PlaceChange::kNone;
}

void fill_mask(std::span<const PlaceChange> events, std::size_t hypothesis, std::size_t num_hypotheses,
               std::vector<std::uint8_t>& mask) {
  const auto first = std::find_if(events.begin(), events.end(), [](PlaceChange e) { return e != PlaceChange::kNone; });
  bool present = first == events.end() || *first != PlaceChange::kCame;
  for (std::size_t v = 0; v < events.size(); ++v) {
    if (events[v] != PlaceChange::kNone) present = events[v] == PlaceChange::kCame;
    mask[v * num_hypotheses + hypothesis] = present ? 1 : 0;
  }
}

// Calls use(hypothesis, changes at its place in each view of the window) for each hypothesis that changes are near to,
// on several threads at once.
template <typename Use>
void visit_changed(std::span<const Hypothesis> hypotheses, const ModelLibrary& library,
                   std::span<const ViewChanges> window, const RemovalSupportOptions& options, int num_threads,
                   const Use& use) {
  options.check();
  if (hypotheses.empty()) return;
  const std::vector<ClusteredChanges> clustered = cluster_changes(window, options, num_threads);
  std::vector<BoundingSphere> balls;
  std::vector<std::uint8_t> changed(hypotheses.size(), 0);
  std::vector<std::unique_ptr<const ProximityGrid>> surfaces(library.objects.size());
  std::vector<std::uint8_t> needed(library.objects.size(), 0);
  for (std::size_t h = 0; h < hypotheses.size(); ++h) {
    const auto object = static_cast<std::size_t>(hypotheses[h].object);
    balls.push_back(bound(library.objects[object], hypotheses[h].world_from_object, options));
    changed[h] = any_near(balls[h], clustered) ? 1 : 0;
    needed[object] |= changed[h];
  }
  parallel_for(surfaces.size(), num_threads, [&](std::size_t o) {
    if (needed[o] != 0)
      surfaces[o] = std::make_unique<const ProximityGrid>(library.objects[o].surface.points, options.model_distance_m);
  });
  parallel_for(hypotheses.size(), num_threads, [&](std::size_t h) {
    if (changed[h] == 0) return;
    const Place place{hypotheses[h].origin_view, *surfaces[static_cast<std::size_t>(hypotheses[h].object)], balls[h],
                      hypotheses[h].world_from_object.inverse()};
    std::vector<PlaceChange> events;
    for (const ClusteredChanges& changes : clustered) events.push_back(find_event(place, changes, options));
    use(h, events);
  });
}

}  // namespace

std::vector<std::uint8_t> compute_presence_mask(std::span<const Hypothesis> hypotheses, const ModelLibrary& library,
                                                std::span<const ViewChanges> window,
                                                const RemovalSupportOptions& options, int num_threads) {
  std::vector<std::uint8_t> mask(window.size() * hypotheses.size(), 1);
  visit_changed(
      hypotheses, library, window, options, num_threads,
      [&](std::size_t h, std::span<const PlaceChange> events) { fill_mask(events, h, hypotheses.size(), mask); });
  return mask;
}

std::vector<std::uint8_t> find_outdated(std::span<const Hypothesis> hypotheses, const ModelLibrary& library,
                                        std::span<const ViewChanges> window, const RemovalSupportOptions& options,
                                        int num_threads) {
  std::vector<std::uint8_t> outdated(hypotheses.size(), 0);
  visit_changed(hypotheses, library, window, options, num_threads,
                [&](std::size_t h, std::span<const PlaceChange> events) {
                  for (std::size_t v = 0; v < events.size(); ++v)
                    if (events[v] != PlaceChange::kNone && window[v].view > hypotheses[h].origin_view) outdated[h] = 1;
                });
  return outdated;
}

void drop_correspondences(std::span<Hypothesis> hypotheses, std::span<const std::uint8_t> outdated) {
  for (std::size_t h = 0; h < outdated.size(); ++h)
    if (outdated[h] != 0) hypotheses[h].correspondences.clear();
}

std::vector<ViewChanges> changes_of(const std::deque<DynamicScene::View>& window) {
  std::vector<ViewChanges> changes;
  for (const DynamicScene::View& view : window)
    changes.push_back({view.number, &view.removed_in_world, &view.novel_in_world});
  return changes;
}

FindPlaceChange make_find_change(const ModelLibrary& library, std::span<const ViewChanges> window,
                                 const RemovalSupportOptions& options) {
  // Most views ask for no place.
  auto clustered_once = std::make_shared<std::optional<std::vector<ClusteredChanges>>>();
  return [&library, window, options, clustered_once](int object, const Rigid3& world_from_object, int seen_view) {
    const ObjectModel& model = library.objects[static_cast<std::size_t>(object)];
    if (!*clustered_once) *clustered_once = cluster_changes(window, options, 1);
    const std::vector<ClusteredChanges>& clustered = **clustered_once;
    const BoundingSphere ball = bound(model, world_from_object, options);
    PlaceChange last = PlaceChange::kNone;
    if (!any_near(ball, clustered)) return last;
    const ProximityGrid surface(model.surface.points, options.model_distance_m);
    const Place place{seen_view, surface, ball, world_from_object.inverse()};
    for (const ClusteredChanges& changes : clustered)
      if (const PlaceChange change = find_event(place, changes, options); change != PlaceChange::kNone) last = change;
    return last;
  };
}

void discard_absent(std::vector<Hypothesis>& hypotheses, std::vector<std::uint8_t>& mask) {
  if (mask.empty()) return;
  const std::size_t num_all = hypotheses.size();
  const std::size_t newest = mask.size() - num_all;  // Of the current view's row.
  std::vector<std::uint8_t> kept_mask;
  for (std::size_t i = 0; i < mask.size(); ++i)
    if (mask[newest + i % num_all] != 0) kept_mask.push_back(mask[i]);
  std::vector<Hypothesis> kept;
  for (std::size_t h = 0; h < num_all; ++h)
    if (mask[newest + h] != 0) kept.push_back(std::move(hypotheses[h]));
  hypotheses = std::move(kept);
  mask = std::move(kept_mask);
}

}  // namespace resight
