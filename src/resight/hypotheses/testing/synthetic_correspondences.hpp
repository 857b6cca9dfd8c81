// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <vector>

#include "resight/core/random.hpp"
#include "resight/geometry/rigid3.hpp"
#include "resight/registration/correspondence.hpp"

namespace resight::testing {

inline Eigen::Vector3d random_direction(Rng& rng) {
  for (;;) {
    const Eigen::Vector3d v{rng.normal(), rng.normal(), rng.normal()};
    if (v.norm() > 1e-3) return v.normalized();
  }
}

inline Rigid3 random_pose(Rng& rng, double max_offset_m = 0.3) {
  const double angle_rad = rng.uniform(0, 3.14159);
  Rigid3 pose = Rigid3::from_axis_angle(random_direction(rng), angle_rad);
  pose.translation = Eigen::Vector3d{rng.uniform(-max_offset_m, max_offset_m), rng.uniform(-max_offset_m, max_offset_m),
                                     1.0 + rng.uniform(-max_offset_m, max_offset_m)};
  return pose;
}

/// A point and its normal, in the same frame.
struct SurfacePoint {
  Eigen::Vector3d point;
  Eigen::Vector3d normal;
};

/// Random point on a box of 8 x 12 x 20 cm or a closed cylinder of 9 x 20 cm, centred at the origin.
inline SurfacePoint random_surface_point(Rng& rng, bool box) {
  if (!box) {
    const double angle = rng.uniform(0, 6.28318);
    const Eigen::Vector3d normal(std::cos(angle), std::sin(angle), 0);
    if (rng.uniform() < 0.2) {
      const double side = rng.below(2) == 0 ? 1.0 : -1.0;
      return {0.045 * std::sqrt(rng.uniform()) * normal + Eigen::Vector3d(0, 0, 0.1 * side),
              Eigen::Vector3d(0, 0, side)};
    }
    return {0.045 * normal + Eigen::Vector3d(0, 0, rng.uniform(-0.1, 0.1)), normal};
  }
  const Eigen::Vector3d half(0.04, 0.06, 0.1);
  const auto axis = static_cast<Eigen::Index>(rng.below(3));
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  normal[axis] = rng.below(2) == 0 ? 1.0 : -1.0;
  Eigen::Vector3d p{rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)};
  p[axis] = normal[axis];
  return {p.cwiseProduct(half), normal};
}

struct ProblemOptions {
  int num_correspondences = 100;  ///< In all.
  int inliers_per_instance = 20;
  int num_instances = 1;
  double noise_m = 0.003;          ///< Of each coordinate of a scene point, standard deviation.
  double normal_noise_rad = 0.12;  ///< Of each component of a scene normal.
  double share_near = 0.4;         ///< Of the outliers: scene point on an instance, but the wrong model point.
  bool side_by_side = false;       ///< Instances 13 cm apart, equally oriented.
  std::uint64_t seed = 1;
};

/// Correspondences of one object with known instances.
struct Problem {
  std::vector<Correspondence> correspondences;  ///< Shuffled.
  std::vector<int> instance;                    ///< Instance of each correspondence; -1 = outlier.
  std::vector<Rigid3> scene_from_object;
};

/// Generates a problem: instances with noisy inliers, then outliers, in random order.
class ProblemMaker {
 public:
  explicit ProblemMaker(const ProblemOptions& options)
      : options_(options), rng_(options.seed), box_(rng_.below(2) == 0) {}

  Problem make() {
    Problem problem;
    for (int i = 0; i < options_.num_instances; ++i) problem.scene_from_object.push_back(next_pose(problem));
    for (int i = 0; i < options_.num_instances; ++i)
      for (int k = 0; k < options_.inliers_per_instance; ++k) {
        const Rigid3& pose = problem.scene_from_object[static_cast<std::size_t>(i)];
        const SurfacePoint m = visible_point(pose);
        add(problem, i, m, {pose * m.point, pose.rotation * m.normal});
      }
    while (static_cast<int>(problem.correspondences.size()) < options_.num_correspondences) add_outlier(problem);
    shuffle(problem);
    return problem;
  }

 private:
  Rigid3 next_pose(const Problem& problem) {
    if (!options_.side_by_side || problem.scene_from_object.empty()) return random_pose(rng_);
    Rigid3 pose = problem.scene_from_object.back();
    pose.translation += pose.rotation.col(1) * 0.13;
    return pose;
  }

  SurfacePoint visible_point(const Rigid3& pose) {
    for (;;) {
      const SurfacePoint m = random_surface_point(rng_, box_);
      const Eigen::Vector3d p = pose * m.point;
      if ((pose.rotation * m.normal).dot(-p.normalized()) > 0.2) return m;
    }
  }

  SurfacePoint outlier_scene_point(const Problem& problem) {
    if (rng_.uniform() < options_.share_near) {
      const Rigid3& pose = problem.scene_from_object[rng_.below(static_cast<std::uint32_t>(options_.num_instances))];
      const SurfacePoint m = visible_point(pose);
      return {pose * m.point, pose.rotation * m.normal};
    }
    // A table top, with clutter of any orientation on it.
    const Eigen::Vector3d p{rng_.uniform(-0.5, 0.5), 0.2, 1.0 + rng_.uniform(-0.5, 0.5)};
    if (rng_.below(2) == 0) return {p, -Eigen::Vector3d::UnitY()};
    return {p - Eigen::Vector3d(0, rng_.uniform(0, 0.25), 0), random_direction(rng_)};
  }

  void add_outlier(Problem& problem) {
    const SurfacePoint model = random_surface_point(rng_, box_);
    add(problem, -1, model, outlier_scene_point(problem));
  }

  void add(Problem& problem, int instance, const SurfacePoint& model, const SurfacePoint& scene) {
    const auto noise = [&](double sigma) {
      return Eigen::Vector3d{sigma * rng_.normal(), sigma * rng_.normal(), sigma * rng_.normal()};
    };
    Correspondence c;
    c.model_point = model.point.cast<float>();
    c.model_normal = model.normal.cast<float>();
    c.scene_point = (scene.point + noise(options_.noise_m)).cast<float>();
    c.scene_normal = (scene.normal + noise(options_.normal_noise_rad)).normalized().cast<float>();
    c.distance_sq = static_cast<float>((instance >= 0 ? 0.3 : 0.45) + 0.15 * rng_.normal());
    c.model_feature = c.scene_feature = static_cast<int>(problem.correspondences.size());
    problem.correspondences.push_back(c);
    problem.instance.push_back(instance);
  }

  void shuffle(Problem& problem) {
    for (std::size_t i = problem.correspondences.size(); i > 1; --i) {
      const std::size_t j = rng_.below(static_cast<std::uint32_t>(i));
      std::swap(problem.correspondences[i - 1], problem.correspondences[j]);
      std::swap(problem.instance[i - 1], problem.instance[j]);
    }
  }

  ProblemOptions options_;
  Rng rng_;
  bool box_;
};

inline Problem make_problem(const ProblemOptions& options) { return ProblemMaker(options).make(); }

/// Whether `pose` is within max_distance_m (at the object's origin, its middle) and max_rotation_rad of `truth`.
inline bool is_near(const Rigid3& pose, const Rigid3& truth, double max_distance_m = 0.02,
                    double max_rotation_rad = 0.26) {
  return (pose.translation - truth.translation).norm() < max_distance_m &&
         rotation_angle_rad(pose.rotation, truth.rotation) < max_rotation_rad;
}

}  // namespace resight::testing
