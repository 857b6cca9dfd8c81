// SPDX-License-Identifier: Apache-2.0
#include "resight/cameras/joint_adjustment.hpp"

#include <utility>

#include "resight/cameras/object_places.hpp"
#include "resight/core/check.hpp"

namespace resight {
namespace {

// Share of the information that remains for the rotation about a symmetry axis, which no view can observe.
constexpr double kFreeShare = 1e-4;

// Information of a recognised pose, for a small motion of the object in its own frame.
TwistMatrix observation_information(const ObjectModel& model, const AdjustJointlyOptions& options) {
  // The rotation is about the centre, not the origin: a point p moves by rotation x (p - centre) + shift.
  const Eigen::Vector3d c = model.center.cast<double>();
  TwistMatrix at_center = TwistMatrix::Identity();
  at_center.bottomLeftCorner<3, 3>() << 0, c.z(), -c.y(), -c.z(), 0, c.x(), c.y(), -c.x(), 0;
  TwistMatrix information = at_center.transpose() * twist_information(options.sigma_rad, options.sigma_m) * at_center;
  for (const RotationAxis& axis : model.symmetries.continuous) {
    Twist free;
    free << axis.direction.normalized(), axis.point.cross(axis.direction.normalized());
    const Twist known = information * free;
    information -= (1 - kFreeShare) / free.dot(known) * known * known.transpose();
  }
  return information;
}

}  // namespace

void AdjustJointlyOptions::check() const {
  same_place.check();
  check_positive("min_observations", min_observations);
  check_positive("sigma_m", sigma_m);
  check_positive("sigma_rad", sigma_rad);
  graph.check();
}

JointAdjustment adjust_jointly(CameraTrack track, std::span<const ObservedObject> observed, const ModelLibrary& library,
                               const AdjustJointlyOptions& options) {
  options.check();
  std::vector<Rigid3> nodes;
  for (const TrackedView& view : track.views) nodes.push_back(view.world_from_camera);
  std::vector<PoseEdge> edges = track.edges;
  std::vector<StaticObject> objects;
  for (const ObjectPlace& place : find_places(track, observed, library, options.same_place)) {
    if (static_cast<int>(place.observations.size()) < options.min_observations) continue;
    const ObjectModel& model = library.objects[static_cast<std::size_t>(place.object)];
    const TwistMatrix information = observation_information(model, options);
    StaticObject object{place.object, place.component, place.component_from_object, {}};
    for (const int i : place.observations) {
      const ObservedObject& o = observed[static_cast<std::size_t>(i)];
      const Rigid3& camera = nodes[static_cast<std::size_t>(o.view)];
      const Rigid3 seen =
          nearest_symmetric_pose(camera * o.camera_from_object, place.component_from_object, model.symmetries);
      edges.push_back({o.view, static_cast<int>(nodes.size()), camera.inverse() * seen, information});
      object.views.push_back(o.view);
    }
    nodes.push_back(place.component_from_object);
    objects.push_back(std::move(object));
  }
  const PoseGraph graph = adjust_pose_graph(std::move(nodes), edges, options.graph);
  for (std::size_t v = 0; v < track.views.size(); ++v) track.views[v].world_from_camera = graph.world_from_node[v];
  for (std::size_t o = 0; o < objects.size(); ++o)
    objects[o].world_from_object = graph.world_from_node[track.views.size() + o];
  return {std::move(track), std::move(objects)};
}

}  // namespace resight
