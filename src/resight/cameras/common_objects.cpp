// SPDX-License-Identifier: Apache-2.0
#include "resight/cameras/common_objects.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "resight/core/check.hpp"
#include "resight/hypotheses/pose_estimation.hpp"

namespace resight {
namespace {

// An object in the frame of a part.
struct PlacedObject {
  int view = 0;
  int object = -1;
  Rigid3 part_from_object;
};

struct Agreement {
  Rigid3 a_from_b;                                         // of the parts' frames
  std::vector<std::pair<std::size_t, std::size_t>> pairs;  // of places
};

bool is_same_place(const ObjectModel& model, const Rigid3& a, const Rigid3& b, const JoinByObjectsOptions& options) {
  const Eigen::Vector3d center = model.center.cast<double>();
  return (a * center - b * center).norm() <= options.max_distance_m &&
         symmetric_rotation_distance_rad(a, b, model.symmetries) <= options.max_rotation_rad;
}

class PartJoiner {
 public:
  PartJoiner(const ModelLibrary& library, const JoinByObjectsOptions& options) : library_(library), options_(options) {}

  // How part b lies in the frame of a: the motion that most objects agree on.
  [[nodiscard]] std::optional<Agreement> join(const std::vector<PlacedObject>& a,
                                              const std::vector<PlacedObject>& b) const {
    std::optional<Agreement> best;
    for (const PlacedObject& in_a : a)
      for (const PlacedObject& in_b : b) {
        if (in_a.object != in_b.object) continue;
        for (const Rigid3& symmetry : enumerate_symmetries(model(in_a).symmetries)) {
          Agreement found = count(a, b, in_a.part_from_object * symmetry * in_b.part_from_object.inverse());
          if (!best || found.pairs.size() > best->pairs.size()) best = std::move(found);
        }
      }
    if (!best || best->pairs.size() < static_cast<std::size_t>(options_.min_objects)) return std::nullopt;
    best->a_from_b = fit(a, b, *best);
    return best;
  }

 private:
  [[nodiscard]] const ObjectModel& model(const PlacedObject& o) const {
    return library_.objects[static_cast<std::size_t>(o.object)];
  }

  [[nodiscard]] Agreement count(const std::vector<PlacedObject>& a, const std::vector<PlacedObject>& b,
                                const Rigid3& a_from_b) const {
    Agreement found{a_from_b, {}};
    for (std::size_t i = 0; i < a.size(); ++i)
      for (std::size_t j = 0; j < b.size(); ++j) {
        if (a[i].object != b[j].object) continue;
        if (!is_same_place(model(a[i]), a[i].part_from_object, a_from_b * b[j].part_from_object, options_)) continue;
        found.pairs.emplace_back(i, j);
        break;
      }
    return found;
  }

  // Least squares over the objects' axes, as long as the objects.
  [[nodiscard]] Rigid3 fit(const std::vector<PlacedObject>& a, const std::vector<PlacedObject>& b,
                           const Agreement& agreement) const {
    std::vector<Eigen::Vector3f> in_a, in_b;
    for (const auto& [i, j] : agreement.pairs) {
      const ObjectModel& m = model(a[i]);
      const Rigid3 expected = agreement.a_from_b * b[j].part_from_object;
      const Rigid3 a_from_object = nearest_symmetric_pose(a[i].part_from_object, expected, m.symmetries);
      const Eigen::Vector3d center = m.center.cast<double>();
      for (int k = 0; k < 4; ++k) {
        Eigen::Vector3d p = center;
        if (k > 0) p[k - 1] += 0.5 * m.diameter_m;
        in_a.push_back((a_from_object * p).cast<float>());
        in_b.push_back((b[j].part_from_object * p).cast<float>());
      }
    }
    return fit_rigid(in_b, in_a).value_or(agreement.a_from_b);
  }

  const ModelLibrary& library_;
  const JoinByObjectsOptions& options_;
};

// Of what several views of a part see at one place, the observation nearest to the others.
std::vector<PlacedObject> merge_places(const std::vector<PlacedObject>& all, const ModelLibrary& library,
                                       const JoinByObjectsOptions& options) {
  const auto model = [&](const PlacedObject& o) -> const ObjectModel& {
    return library.objects[static_cast<std::size_t>(o.object)];
  };
  std::vector<std::vector<PlacedObject>> places;
  for (const PlacedObject& o : all) {
    const auto place = std::ranges::find_if(places, [&](const std::vector<PlacedObject>& p) {
      return p[0].object == o.object && is_same_place(model(o), p[0].part_from_object, o.part_from_object, options);
    });
    if (place != places.end())
      place->push_back(o);
    else
      places.push_back({o});
  }
  std::vector<PlacedObject> merged;
  for (const std::vector<PlacedObject>& place : places) {
    const auto sum_of_distances = [&](const PlacedObject& o) {
      const Eigen::Vector3d center = model(o).center.cast<double>();
      double sum = 0;
      for (const PlacedObject& other : place)
        sum += (o.part_from_object * center - other.part_from_object * center).norm();
      return sum;
    };
    merged.push_back(*std::ranges::min_element(place, {}, sum_of_distances));
  }
  return merged;
}

std::vector<std::vector<PlacedObject>> place_objects(const CameraTrack& track, std::span<const ObservedObject> observed,
                                                     const ModelLibrary& library, const JoinByObjectsOptions& options) {
  std::vector<std::vector<PlacedObject>> of_part(static_cast<std::size_t>(track.num_parts));
  for (const ObservedObject& o : observed) {
    const TrackedView& view = track.views[static_cast<std::size_t>(o.view)];
    of_part[static_cast<std::size_t>(view.part)].push_back(
        {o.view, o.object, view.world_from_camera * o.camera_from_object});
  }
  for (std::vector<PlacedObject>& placed : of_part) placed = merge_places(placed, library, options);
  return of_part;
}

Eigen::Matrix<double, 6, 6> information_of(const Agreement& agreement, const JoinByObjectsOptions& options) {
  Twist diagonal;
  diagonal << Eigen::Vector3d::Constant(1 / (options.sigma_rad * options.sigma_rad)),
      Eigen::Vector3d::Constant(1 / (options.sigma_m * options.sigma_m));
  return static_cast<double>(agreement.pairs.size()) * Eigen::Matrix<double, 6, 6>(diagonal.asDiagonal());
}

// Part b into the frame of a.
void merge_parts(CameraTrack& track, int a, int b, const Rigid3& a_from_b) {
  for (TrackedView& view : track.views) {
    if (view.part != b) continue;
    view.world_from_camera = a_from_b * view.world_from_camera;
    view.part = a;
  }
}

void renumber_parts(CameraTrack& track) {
  const std::vector<int> parts = find_connected_parts(track.views.size(), track.edges);
  track.num_parts = 0;
  for (std::size_t v = 0; v < track.views.size(); ++v) {
    track.views[v].part = parts[v];
    track.num_parts = std::max(track.num_parts, parts[v] + 1);
  }
}

// In the frame of the first view of each part.
void put_first_views_at_origin(CameraTrack& track) {
  std::vector<std::optional<Rigid3>> first_from_world(static_cast<std::size_t>(track.num_parts));
  for (TrackedView& view : track.views) {
    std::optional<Rigid3>& first = first_from_world[static_cast<std::size_t>(view.part)];
    const bool is_first = !first;
    if (is_first) first = view.world_from_camera.inverse();
    view.world_from_camera = is_first ? Rigid3::identity() : *first * view.world_from_camera;
  }
}

}  // namespace

void JoinByObjectsOptions::check() const {
  check_positive("min_objects", min_objects);
  check_positive("max_distance_m", max_distance_m);
  check_positive("max_rotation_rad", max_rotation_rad);
  check_positive("sigma_m", sigma_m);
  check_positive("sigma_rad", sigma_rad);
}

CameraTrack join_by_objects(CameraTrack track, std::span<const ObservedObject> observed, const ModelLibrary& library,
                            const JoinByObjectsOptions& options) {
  options.check();
  for (const ObservedObject& o : observed)
    require(o.view >= 0 && static_cast<std::size_t>(o.view) < track.views.size() && o.object >= 0 &&
                static_cast<std::size_t>(o.object) < library.objects.size(),
            "observed: must name views of the track and objects of the library");
  const PartJoiner joiner(library, options);
  for (bool joined = true; joined;) {
    joined = false;
    const auto of_part = place_objects(track, observed, library, options);
    std::optional<Agreement> best;
    std::pair<std::size_t, std::size_t> parts;
    for (std::size_t b = 0; b < of_part.size(); ++b)
      for (std::size_t a = 0; a < b; ++a) {
        std::optional<Agreement> found = joiner.join(of_part[a], of_part[b]);
        if (!found || (best && found->pairs.size() <= best->pairs.size())) continue;
        best = std::move(found);
        parts = {a, b};
      }
    if (!best) break;
    merge_parts(track, static_cast<int>(parts.first), static_cast<int>(parts.second), best->a_from_b);
    const auto& [i, j] = best->pairs.front();
    const int view_a = of_part[parts.first][i].view, view_b = of_part[parts.second][j].view;
    track.edges.push_back({view_a, view_b,
                           track.views[static_cast<std::size_t>(view_a)].world_from_camera.inverse() *
                               track.views[static_cast<std::size_t>(view_b)].world_from_camera,
                           information_of(*best, options)});
    renumber_parts(track);
    joined = true;
  }
  put_first_views_at_origin(track);
  return track;
}

}  // namespace resight
