// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

#include "resight/core/image.hpp"
#include "resight/geometry/camera.hpp"
#include "resight/geometry/rigid3.hpp"
#include "resight/geometry/triangle_mesh.hpp"

namespace resight {

// The errors of poses by which the BOP benchmark ranks (Hodan et al., "BOP Challenge 2020 on 6D Object Localization",
// sec. 2.2; its thresholds: bop_average_recall.hpp). Poses: camera_from_object. `symmetries`: motions of the object
// frame that map the object onto itself, the identity among them (enumerate_symmetries()).

/// Maximum symmetry-aware surface distance, metres: the largest distance of a vertex between both poses, for the
/// symmetry for which it is least.
[[nodiscard]] double mssd_m(const Rigid3& estimate, const Rigid3& truth, std::span<const Eigen::Vector3f> vertices,
                            std::span<const Rigid3> symmetries);

/// Maximum symmetry-aware projection distance, pixels: the same in the image. Infinite if a vertex is not in front of
/// the camera.
[[nodiscard]] double mspd_px(const Rigid3& estimate, const Rigid3& truth, std::span<const Eigen::Vector3f> vertices,
                             std::span<const Rigid3> symmetries, const Camera& camera);

/// Depth (along z, metres; NaN = nothing) of an object alone.
[[nodiscard]] Image<float> render_object_depth(const TriangleMesh& mesh, const Camera& camera,
                                               const Rigid3& camera_from_object);

struct VsdOptions {
  double visibility_tolerance_m = 0.015;  ///< delta of BOP.
  std::vector<double> misalignment_shares{
      0.05, 0.10, 0.15, 0.20, 0.25, 0.30, 0.35, 0.40, 0.45, 0.50};  ///< tau, of
                                                                    ///< the diameter.
  void check() const;
};

/// Visible surface discrepancy for each tau: of the pixels at which the object is visible in either pose, the share at
/// which it is visible in one only or its two surfaces are tau or more apart (along the ray, as BOP measures). Visible
/// is what is not behind the measured surface by more than delta; where nothing was measured, the object counts as
/// visible (BOP since 2019), and the estimate also where the truth is visible. 1 if the object is visible in neither.
/// The depth images are of the camera's size, NaN = nothing.
[[nodiscard]] std::vector<double> vsd_errors(const Image<float>& estimate_depth_m, const Image<float>& truth_depth_m,
                                             const Image<float>& measured_depth_m, const Camera& camera,
                                             double diameter_m, const VsdOptions& options = {});

}  // namespace resight
