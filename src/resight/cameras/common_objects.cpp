// SPDX-License-Identifier: Apache-2.0
#include "resight/cameras/common_objects.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <optional>
#include <utility>

#include "resight/cameras/object_places.hpp"
#include "resight/core/check.hpp"
#include "resight/registration/pose_estimation.hpp"

namespace resight {
namespace {

// Candidates are the same if they differ by less at the objects on which they agree.
constexpr double kSameCandidate_m = 0.01;

using PlacePair = std::pair<const ObjectPlace*, const ObjectPlace*>;

// A possible relative pose of two components.
struct Candidate {
  int component_a = 0;
  int component_b = 0;
  Rigid3 a_from_b;  // Between the frames of the components.
  std::vector<PlacePair> agreed;
  double surface_score = 0;
};

class PartJoiner {
 public:
  PartJoiner(const CameraTrack& track, const ModelLibrary& library, std::span<const AlignmentView> views,
             const JoinByObjectsOptions& options)
      : track_(track), library_(library), views_(views), options_(options) {}

  // Pose of component b in the frame of a on which most objects agree and which the surfaces do not contradict.
  [[nodiscard]] std::optional<Candidate> join(int a, int b, std::span<const ObjectPlace> in_a,
                                              std::span<const ObjectPlace> in_b) const {
    std::optional<Candidate> best;
    for (Candidate& candidate : propose(a, b, in_a, in_b)) {
      const std::optional<double> score = compare_surfaces(candidate);
      if (!score) continue;
      candidate.surface_score = *score;
      if (!best || is_better(candidate, *best)) best = std::move(candidate);
    }
    return best;
  }

  [[nodiscard]] static bool is_better(const Candidate& x, const Candidate& y) {
    return std::pair(x.agreed.size(), x.surface_score) > std::pair(y.agreed.size(), y.surface_score);
  }

 private:
  [[nodiscard]] const ObjectModel& model(const ObjectPlace& place) const {
    return library_.objects[static_cast<std::size_t>(place.object)];
  }

  // The candidates with the most agreeing objects, without duplicates.
  [[nodiscard]] std::vector<Candidate> propose(int a, int b, std::span<const ObjectPlace> in_a,
                                               std::span<const ObjectPlace> in_b) const {
    std::vector<Candidate> all;
    for (const ObjectPlace& place_a : in_a)
      for (const ObjectPlace& place_b : in_b) {
        if (place_a.object != place_b.object) continue;
        for (const Rigid3& symmetry : enumerate_symmetries(model(place_a).symmetries)) {
          Candidate found{a, b, place_a.component_from_object * symmetry * place_b.component_from_object.inverse(), {}};
          found.agreed = find_agreed(in_a, in_b, found.a_from_b);
          if (static_cast<int>(found.agreed.size()) < options_.min_objects) continue;
          found.a_from_b = fit(found);
          all.push_back(std::move(found));
        }
      }
    std::ranges::stable_sort(all, std::greater<>(), [](const Candidate& c) { return c.agreed.size(); });
    std::vector<Candidate> distinct;
    for (Candidate& candidate : all) {
      if (static_cast<int>(distinct.size()) == options_.max_candidates) break;
      const bool known = std::ranges::any_of(distinct, [&](const Candidate& d) { return are_same(d, candidate); });
      if (!known) distinct.push_back(std::move(candidate));
    }
    return distinct;
  }

  [[nodiscard]] bool are_same(const Candidate& x, const Candidate& y) const {
    return std::ranges::all_of(y.agreed, [&](const auto& pair) {
      const std::array<Eigen::Vector3d, 4> points = axes_of(*pair.second);
      return std::ranges::all_of(points, [&](const Eigen::Vector3d& p) {
        return (x.a_from_b * p - y.a_from_b * p).norm() < kSameCandidate_m;
      });
    });
  }

  // The object's centre and the ends of its axes, in the frame of its component.
  [[nodiscard]] std::array<Eigen::Vector3d, 4> axes_of(const ObjectPlace& place) const {
    std::array<Eigen::Vector3d, 4> points;
    for (int k = 0; k < 4; ++k) {
      Eigen::Vector3d p = model(place).center.cast<double>();
      if (k > 0) p[k - 1] += 0.5 * model(place).diameter_m;
      points[static_cast<std::size_t>(k)] = place.component_from_object * p;
    }
    return points;
  }

  [[nodiscard]] std::vector<PlacePair> find_agreed(std::span<const ObjectPlace> in_a, std::span<const ObjectPlace> in_b,
                                                   const Rigid3& a_from_b) const {
    std::vector<PlacePair> agreed;
    for (const ObjectPlace& a : in_a) {
      const auto b = std::ranges::find_if(in_b, [&](const ObjectPlace& p) {
        return is_same(a, p, a_from_b) && std::ranges::none_of(agreed, [&](const PlacePair& other) {
                 return is_one_object({&a, &p}, other);
               });
      });
      if (b != in_b.end()) agreed.emplace_back(&a, &*b);
    }
    return agreed;
  }

  // Noisy observations of one object may make several places, which are no further evidence.
  [[nodiscard]] bool is_one_object(const PlacePair& x, const PlacePair& y) const {
    return is_same(*x.first, *y.first, Rigid3::identity()) || is_same(*x.second, *y.second, Rigid3::identity());
  }

  [[nodiscard]] bool is_same(const ObjectPlace& a, const ObjectPlace& b, const Rigid3& a_from_b) const {
    return a.object == b.object &&
           is_same_place(model(a), a.component_from_object, a_from_b * b.component_from_object, options_.same_place);
  }

  // Least squares over the objects' axes, which are scaled to the size of the object.
  [[nodiscard]] Rigid3 fit(const Candidate& candidate) const {
    std::vector<Eigen::Vector3f> in_a, in_b;
    for (const auto& [a, b] : candidate.agreed) {
      ObjectPlace turned = *a;
      turned.component_from_object = nearest_symmetric_pose(
          a->component_from_object, candidate.a_from_b * b->component_from_object, model(*a).symmetries);
      for (const Eigen::Vector3d& p : axes_of(turned)) in_a.push_back(p.cast<float>());
      for (const Eigen::Vector3d& p : axes_of(*b)) in_b.push_back(p.cast<float>());
    }
    return fit_rigid(in_b, in_a).value_or(candidate.a_from_b);
  }

  [[nodiscard]] std::vector<AlignmentTarget> targets_of(int component) const {
    std::vector<AlignmentTarget> targets;
    for (std::size_t v = 0; v < views_.size(); ++v)
      if (track_.views[v].component == component && !views_[v].levels.empty())
        targets.push_back({&views_[v], track_.views[v].world_from_camera});
    return targets;
  }

  // Overlap minus free-space violations of each component's views in the other. None if the components contradict each
  // other.
  [[nodiscard]] std::optional<double> compare_surfaces(const Candidate& candidate) const {
    const std::vector<AlignmentTarget> a = targets_of(candidate.component_a), b = targets_of(candidate.component_b);
    if (a.empty() || b.empty()) return 0;
    const AlignedView b_in_a = judge(b, a, candidate.a_from_b), a_in_b = judge(a, b, candidate.a_from_b.inverse());
    if (std::max(b_in_a.seen_through, a_in_b.seen_through) > options_.max_seen_through) return std::nullopt;
    return b_in_a.overlap + a_in_b.overlap - 2 * (b_in_a.seen_through + a_in_b.seen_through);
  }

  // Means over the views.
  [[nodiscard]] AlignedView judge(const std::vector<AlignmentTarget>& views,
                                  const std::vector<AlignmentTarget>& targets, const Rigid3& targets_from_views) const {
    AlignedView mean;
    for (const AlignmentTarget& view : views) {
      const AlignedView one =
          evaluate_alignment(*view.view, targets, targets_from_views * view.world_from_camera, options_.align);
      mean.overlap += one.overlap / static_cast<double>(views.size());
      mean.seen_through += one.seen_through / static_cast<double>(views.size());
    }
    return mean;
  }

  const CameraTrack& track_;
  const ModelLibrary& library_;
  std::span<const AlignmentView> views_;
  const JoinByObjectsOptions& options_;
};

std::span<const ObjectPlace> places_of(const std::vector<ObjectPlace>& places, int component) {
  const auto begin = std::ranges::lower_bound(places, component, {}, &ObjectPlace::component);
  const auto end = std::ranges::upper_bound(places, component, {}, &ObjectPlace::component);
  return {begin, end};
}

std::optional<Candidate> find_best_join(const CameraTrack& track, const std::vector<ObjectPlace>& places,
                                        const PartJoiner& joiner) {
  std::optional<Candidate> best;
  for (int b = 0; b < track.num_components; ++b)
    for (int a = 0; a < b; ++a) {
      std::optional<Candidate> found = joiner.join(a, b, places_of(places, a), places_of(places, b));
      if (found && (!best || PartJoiner::is_better(*found, *best))) best = std::move(found);
    }
  return best;
}

// Moves component b into the frame of a and adds an edge that holds it there.
void merge_components(CameraTrack& track, const Candidate& join, int view_a, int view_b,
                      const JoinByObjectsOptions& options) {
  for (TrackedView& view : track.views)
    if (view.component == join.component_b) view.world_from_camera = join.a_from_b * view.world_from_camera;
  track.edges.push_back(
      {view_a, view_b,
       track.views[static_cast<std::size_t>(view_a)].world_from_camera.inverse() *
           track.views[static_cast<std::size_t>(view_b)].world_from_camera,
       static_cast<double>(join.agreed.size()) * twist_information(options.sigma_rad, options.sigma_m)});
  const std::vector<int> components = find_connected_components(track.views.size(), track.edges);
  track.num_components = 0;
  for (std::size_t v = 0; v < track.views.size(); ++v) {
    track.views[v].component = components[v];
    track.num_components = std::max(track.num_components, components[v] + 1);
  }
}

// Expresses the poses of each component in the frame of its first view.
void put_first_views_at_origin(CameraTrack& track) {
  std::vector<std::optional<Rigid3>> first_from_world(static_cast<std::size_t>(track.num_components));
  for (TrackedView& view : track.views) {
    std::optional<Rigid3>& first = first_from_world[static_cast<std::size_t>(view.component)];
    const bool is_first = !first;
    if (is_first) first = view.world_from_camera.inverse();
    view.world_from_camera = is_first ? Rigid3::identity() : *first * view.world_from_camera;
  }
}

}  // namespace

void JoinByObjectsOptions::check() const {
  same_place.check();
  check_positive("min_objects", min_objects);
  check_positive("max_candidates", max_candidates);
  check_in_range("max_seen_through", max_seen_through, 0, 1);
  check_positive("sigma_m", sigma_m);
  check_positive("sigma_rad", sigma_rad);
  align.check();
}

CameraTrack join_by_objects(CameraTrack track, std::span<const ObservedObject> observed, const ModelLibrary& library,
                            std::span<const AlignmentView> views, const JoinByObjectsOptions& options) {
  options.check();
  require(views.empty() || views.size() == track.views.size(), "views: must hold one entry per view of the track");
  while (true) {
    const std::vector<ObjectPlace> places = find_places(track, observed, library, options.same_place);
    const std::optional<Candidate> join = find_best_join(track, places, PartJoiner(track, library, views, options));
    if (!join) break;
    const auto& [a, b] = join->agreed.front();
    merge_components(track, *join, observed[static_cast<std::size_t>(a->observations.front())].view,
                     observed[static_cast<std::size_t>(b->observations.front())].view, options);
  }
  put_first_views_at_origin(track);
  return track;
}

}  // namespace resight
