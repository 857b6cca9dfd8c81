// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>

namespace resight {

/// A rigid motion in metres, named by its frames: `p_in_a = a_from_b * p_in_b`, `a_from_c = a_from_b * b_from_c`.
/// `rotation` must be a proper orthonormal matrix; is_rigid() checks it.
struct Rigid3 {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  [[nodiscard]] static Rigid3 identity() { return {}; }
  /// From the upper 3x4 part of a homogeneous matrix. Not checked (see is_rigid()).
  [[nodiscard]] static Rigid3 from_matrix(const Eigen::Matrix4d& m);
  [[nodiscard]] static Rigid3 from_rotation(const Eigen::Matrix3d& r) { return {r, Eigen::Vector3d::Zero()}; }
  [[nodiscard]] static Rigid3 from_translation(const Eigen::Vector3d& t) { return {Eigen::Matrix3d::Identity(), t}; }
  /// Rotation by `angle_rad` about `axis` through the origin. `axis` need not be normalised.
  [[nodiscard]] static Rigid3 from_axis_angle(const Eigen::Vector3d& axis, double angle_rad);

  [[nodiscard]] Eigen::Matrix4d matrix() const;
  [[nodiscard]] Rigid3 inverse() const;

  /// Whether the motion is finite, orthonormal within `tolerance`, and not a reflection.
  [[nodiscard]] bool is_rigid(double tolerance = 1e-3) const;
};

[[nodiscard]] inline Rigid3 operator*(const Rigid3& a_from_b, const Rigid3& b_from_c) {
  return {a_from_b.rotation * b_from_c.rotation, a_from_b.rotation * b_from_c.translation + a_from_b.translation};
}
[[nodiscard]] inline Eigen::Vector3d operator*(const Rigid3& a_from_b, const Eigen::Vector3d& p_in_b) {
  return a_from_b.rotation * p_in_b + a_from_b.translation;
}

/// A rigid motion in single precision, for loops over points: `Rigid3f f(a_from_b); p_in_a = f * p_in_b;`
struct Rigid3f {
  explicit Rigid3f(const Rigid3& a_from_b)
      : rotation(a_from_b.rotation.cast<float>()), translation(a_from_b.translation.cast<float>()) {}
  Eigen::Matrix3f rotation;
  Eigen::Vector3f translation;
  [[nodiscard]] Eigen::Vector3f operator*(const Eigen::Vector3f& p_in_b) const {
    return rotation * p_in_b + translation;
  }
};

/// Geodesic angle between two rotations, in radians in [0, pi].
[[nodiscard]] double rotation_angle_rad(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b);

/// The motion at `share` of the way from `from` (0) to `to` (1): linear in the translation, and at constant speed along
/// the shorter rotation.
[[nodiscard]] Rigid3 interpolate(const Rigid3& from, const Rigid3& to, double share);

/// Whether two cameras at these poses see the same rays: equal within 1e-6 (m, and entries of the rotation), which is
/// far below a pixel.
[[nodiscard]] bool is_same_pose(const Rigid3& a, const Rigid3& b);

/// The nearest proper rotation (by SVD), for matrices read from text with few digits.
[[nodiscard]] Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& m);

}  // namespace resight
