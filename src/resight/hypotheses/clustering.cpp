// SPDX-License-Identifier: Apache-2.0
#include "resight/hypotheses/clustering.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>
#include <tuple>

#include "resight/core/parallel.hpp"
#include "resight/geometry/symmetry.hpp"

namespace resight {
namespace {

const Hypothesis& at(std::span<const Hypothesis> hypotheses, int index) {
  return hypotheses[static_cast<std::size_t>(index)];
}

std::vector<int> seed_order(std::span<const Hypothesis> hypotheses) {
  std::vector<int> order(hypotheses.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int ia, int ib) {
    const Hypothesis& a = at(hypotheses, ia);
    const Hypothesis& b = at(hypotheses, ib);
    if (a.correspondences.size() != b.correspondences.size())
      return a.correspondences.size() > b.correspondences.size();
    if (a.origin_view != b.origin_view) return a.origin_view > b.origin_view;
    return a.id < b.id;
  });
  return order;
}

// What Eq. (1) needs to know about an object, prepared once.
struct ObjectNeighborhood {
  const ObjectModel* model = nullptr;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  // Largest shift of the centre under a symmetry, because the centre lies only approximately on the axis.
  double center_shift_m = 0;
};

ObjectNeighborhood neighborhood_of(const ObjectModel& model) {
  ObjectNeighborhood result{&model, model.center.cast<double>(), 0};
  for (const Rigid3& d : model.symmetries.discrete)
    result.center_shift_m = std::max(result.center_shift_m, (d * result.center - result.center).norm());
  for (const auto& c : model.symmetries.continuous)
    result.center_shift_m += 2 * c.direction.normalized().cross(result.center - c.point).norm();
  return result;
}

// The member's pose in the seed's symmetry branch, if both belong to one cluster by Eq. (1).
std::optional<Rigid3> matching_pose(const Rigid3& member, const Rigid3& seed, const ObjectNeighborhood& object,
                                    const ClusterHypothesesOptions& options) {
  const double offset_m = (member * object.center - seed * object.center).norm();
  if (!(offset_m - object.center_shift_m < options.max_translation_m)) return std::nullopt;
  const Rigid3 equivalent = nearest_symmetric_pose(member, seed, object.model->symmetries);
  const bool near =
      (equivalent * object.center - seed * object.center).norm() < options.max_translation_m &&
      rotations_are_near(seed.rotation, equivalent.rotation, options.max_rotation_rad, options.rotation_test);
  return near ? std::optional(equivalent) : std::nullopt;
}

struct Member {
  int index = -1;
  Rigid3 equivalent_pose;  // world_from_object; of the object's equivalent poses, the one nearest to the seed's.
};

using Cluster = std::vector<Member>;

std::vector<Cluster> assign_members(std::span<const Hypothesis> hypotheses, const ModelLibrary& library,
                                    const ClusterHypothesesOptions& options) {
  std::vector<ObjectNeighborhood> objects;
  for (const ObjectModel& model : library.objects) objects.push_back(neighborhood_of(model));
  const std::vector<int> order = seed_order(hypotheses);
  std::vector<std::uint8_t> taken(hypotheses.size(), 0);
  std::vector<Cluster> clusters;
  for (std::size_t s = 0; s < order.size(); ++s) {
    if (taken[static_cast<std::size_t>(order[s])] != 0) continue;
    const Hypothesis& seed = at(hypotheses, order[s]);
    Cluster cluster{{order[s], seed.world_from_object}};
    for (std::size_t m = s + 1; m < order.size(); ++m) {
      const Hypothesis& member = at(hypotheses, order[m]);
      if (taken[static_cast<std::size_t>(order[m])] != 0 || member.object != seed.object) continue;
      const auto pose = matching_pose(member.world_from_object, seed.world_from_object,
                                      objects[static_cast<std::size_t>(seed.object)], options);
      if (!pose) continue;
      taken[static_cast<std::size_t>(order[m])] = 1;
      cluster.push_back({order[m], *pose});
    }
    clusters.push_back(std::move(cluster));
  }
  return clusters;
}

// Equal for correspondences that entered the pool twice, from two groups of one view. The scene point identifies the
// view: keypoints of two views never have the same bits, and correspondences from an earlier clustering have no single
// view.
using CorrespondenceKey = std::array<std::uint32_t, 6>;

CorrespondenceKey key_of(const Correspondence& c) {
  const Eigen::Vector3f& p = c.scene_point;
  return {static_cast<std::uint32_t>(c.type),          static_cast<std::uint32_t>(c.model_feature),
          static_cast<std::uint32_t>(c.scene_feature), std::bit_cast<std::uint32_t>(p.x()),
          std::bit_cast<std::uint32_t>(p.y()),         std::bit_cast<std::uint32_t>(p.z())};
}

void append_views(std::vector<int>& views, const Hypothesis& hypothesis) {
  if (hypothesis.origin_views.empty())
    views.push_back(hypothesis.origin_view);
  else
    views.insert(views.end(), hypothesis.origin_views.begin(), hypothesis.origin_views.end());
}

Hypothesis merge(const Cluster& cluster, std::span<const Hypothesis> hypotheses, const ModelLibrary& library,
                 const ClusterHypothesesOptions& options, const EstimatePoseOptions& pose_options) {
  Hypothesis merged = at(hypotheses, cluster.front().index);
  if (merged.origin_views.empty()) merged.origin_views = {merged.origin_view};
  if (cluster.size() == 1) return merged;
  const ObjectModel& object = library.objects[static_cast<std::size_t>(merged.object)];
  std::vector<Correspondence> pool = std::move(merged.correspondences);
  for (auto member = cluster.begin() + 1; member != cluster.end(); ++member) {
    const Hypothesis& hypothesis = at(hypotheses, member->index);
    append_correspondences(pool, hypothesis, member->equivalent_pose);
    append_views(merged.origin_views, hypothesis);
    merged.origin_view = std::max(merged.origin_view, hypothesis.origin_view);
  }
  std::sort(merged.origin_views.begin(), merged.origin_views.end());
  merged.origin_views.erase(std::unique(merged.origin_views.begin(), merged.origin_views.end()),
                            merged.origin_views.end());
  merged.correspondences = without_repeats(pool);
  const auto estimate = estimate_pose(merged.correspondences, pose_options);
  if (!estimate) return merged;
  const Rigid3& pose = estimate->scene_from_model;
  const Eigen::Vector3d center = object.center.cast<double>();
  if ((pose * center - merged.world_from_object * center).norm() < options.max_translation_m &&
      rotations_are_near(merged.world_from_object.rotation, pose.rotation, options.max_rotation_rad,
                         options.rotation_test))
    merged.world_from_object = pose;
  return merged;
}

}  // namespace

std::vector<Correspondence> without_repeats(std::span<const Correspondence> pool) {
  std::vector<std::pair<CorrespondenceKey, std::size_t>> keys;
  keys.reserve(pool.size());
  for (std::size_t i = 0; i < pool.size(); ++i) keys.emplace_back(key_of(pool[i]), i);
  std::sort(keys.begin(), keys.end());
  std::vector<std::size_t> firsts;
  for (std::size_t i = 0; i < keys.size(); ++i)
    if (i == 0 || keys[i].first != keys[i - 1].first) firsts.push_back(keys[i].second);
  std::sort(firsts.begin(), firsts.end());
  std::vector<Correspondence> result;
  result.reserve(firsts.size());
  for (const std::size_t i : firsts) result.push_back(pool[i]);
  return result;
}

void append_correspondences(std::vector<Correspondence>& pool, const Hypothesis& hypothesis,
                            const Rigid3& equivalent_pose) {
  if (equivalent_pose.rotation == hypothesis.world_from_object.rotation &&
      equivalent_pose.translation == hypothesis.world_from_object.translation) {
    pool.insert(pool.end(), hypothesis.correspondences.begin(), hypothesis.correspondences.end());
    return;
  }
  const Rigid3 object_from_object = equivalent_pose.inverse() * hypothesis.world_from_object;
  for (Correspondence c : hypothesis.correspondences) {
    c.model_point = (object_from_object * c.model_point.cast<double>().eval()).cast<float>();
    c.model_normal = (object_from_object.rotation * c.model_normal.cast<double>()).cast<float>();
    pool.push_back(c);
  }
}

bool rotations_are_near(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b, double max_rotation_rad,
                        RotationTest test) {
  if (test == RotationTest::kGeodesic) return rotation_angle_rad(a, b) < max_rotation_rad;
  // Eq. (1): R^j R^iT, the rotation from b to a about the world axes.
  const Eigen::Matrix3d r = a * b.transpose();
  const double yaw = std::atan2(r(1, 0), r(0, 0));
  const double pitch = std::atan2(-r(2, 0), std::hypot(r(2, 1), r(2, 2)));
  const double roll = std::atan2(r(2, 1), r(2, 2));
  return std::abs(yaw) < max_rotation_rad && std::abs(pitch) < max_rotation_rad && std::abs(roll) < max_rotation_rad;
}

ClusterResult cluster_hypotheses(std::span<const Hypothesis> hypotheses, const ModelLibrary& library,
                                 const ClusterHypothesesOptions& options, const EstimatePoseOptions& pose) {
  options.check();
  pose.check();
  for (const Hypothesis& h : hypotheses) std::ignore = library.object(h.object);  // Throws early.
  const std::vector<Cluster> clusters = assign_members(hypotheses, library, options);
  ClusterResult result;
  result.hypotheses.resize(clusters.size());
  result.members.resize(clusters.size());
  parallel_for(clusters.size(), options.num_threads, [&](std::size_t i) {
    for (const Member& member : clusters[i]) result.members[i].push_back(member.index);
    result.hypotheses[i] = merge(clusters[i], hypotheses, library, options, pose);
  });
  return result;
}

}  // namespace resight
