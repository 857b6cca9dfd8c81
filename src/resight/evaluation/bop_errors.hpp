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

// Pose errors of the BOP benchmark (Hodan et al., "BOP Challenge 2020 on 6D Object Localization", Sec. 2.2; thresholds:
// bop_average_recall.hpp). Poses are camera_from_object. `symmetries`: motions of the object frame that map the object
// onto itself, including the identity (enumerate_symmetries()). Throws std::invalid_argument for empty vertices or
// symmetries, or images of another size.

/// Maximum symmetry-aware surface distance (MSSD), metres: the largest distance of a vertex between both poses,
/// minimised over the symmetries.
[[nodiscard]] double mssd_m(const Rigid3& estimate, const Rigid3& truth, std::span<const Eigen::Vector3f> vertices,
                            std::span<const Rigid3> symmetries);

/// Maximum symmetry-aware projection distance (MSPD), pixels: the same in the image. Infinite if a vertex is not in
/// front of the camera.
[[nodiscard]] double mspd_px(const Rigid3& estimate, const Rigid3& truth, std::span<const Eigen::Vector3f> vertices,
                             std::span<const Rigid3> symmetries, const Camera& camera);

/// Renders the depth of a single object (along z, metres; NaN = no surface).
[[nodiscard]] Image<float> render_object_depth(const TriangleMesh& mesh, const Camera& camera,
                                               const Rigid3& camera_from_object);

struct VsdOptions {
  double visibility_tolerance_m = 0.015;  ///< delta of BOP.
  /// tau, of the diameter.
  std::vector<double> misalignment_shares{0.05, 0.10, 0.15, 0.20, 0.25, 0.30, 0.35, 0.40, 0.45, 0.50};
  void check() const;
};

/// Visible surface discrepancy (VSD) per tau. Of the pixels at which the object is visible in either pose, the share at
/// which it is visible in one only, or its surfaces are at least tau apart (along the ray, as in BOP). A surface is
/// visible if it is at most delta behind the measured one. Where nothing was measured, the object counts as visible
/// (BOP since 2019); the estimate also counts as visible where the truth is. 1 if the object is visible in neither
/// pose. Depth images have the camera's size; NaN = no surface.
[[nodiscard]] std::vector<double> vsd_errors(const Image<float>& estimate_depth_m, const Image<float>& truth_depth_m,
                                             const Image<float>& measured_depth_m, const Camera& camera,
                                             double diameter_m, const VsdOptions& options = {});

}  // namespace resight
