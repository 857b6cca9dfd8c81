// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "resight/core/image.hpp"
#include "resight/core/options.hpp"
#include "resight/geometry/camera.hpp"
#include "resight/geometry/rigid3.hpp"

namespace resight {

/// What a depth view says about a surface point. Only kSeenThrough is evidence of absence.
enum class Evidence : std::uint8_t {
  kUnobserved,   ///< No return, outside the image, behind the camera, or seen at too grazing an angle.
  kOccluded,     ///< Behind the measured depth by more than the margin.
  kPresent,      ///< At the measured depth, within the margin.
  kSeenThrough,  ///< In front of the measured depth by more than the margin: the view sees free space there.
};

/// Whether the view says anything about the point itself.
[[nodiscard]] constexpr bool is_observed(Evidence evidence) {
  return evidence == Evidence::kPresent || evidence == Evidence::kSeenThrough;
}

/// Tolerance along z between a surface and the measured depth.
struct DepthMargin {
  double base_m = 0.015;
  double noise_sigmas = 3;

  /// In metres, for a surface at this depth.
  [[nodiscard]] float at(float z_m, const DepthNoise& noise) const {
    return noise_sigmas > 0 ? with_noise(z_m, noise) : static_cast<float>(base_m);
  }

 private:
  [[nodiscard]] float with_noise(float z_m, const DepthNoise& noise) const;
};

inline void declare(OptionVisitor& v, DepthMargin& o) {
  v.field("base_m", o.base_m, at_least(0), "Depth within this of a surface, plus the noise, confirms it.");
  v.field("noise_sigmas", o.noise_sigmas, at_least(0),
          "Noise, in standard deviations of the depth of a surface seen head-on. 0: none.", "Nguyen et al. 2012");
}

/// A depth image (metres along z, NaN: no return) and its camera, which must outlive it.
struct DepthImage {
  const Camera& camera;
  const Image<float>& depth_m;
};

/// Points of a surface with their unit normals, in one frame, which must outlive it.
struct OrientedPoints {
  std::span<const Eigen::Vector3f> points;
  std::span<const Eigen::Vector3f> normals = {};  ///< Empty, or one per point.
};

struct SurfaceEvidenceOptions {
  DepthMargin margin{};
  int window_radius_px = 0;
  double min_viewing_cosine = 0.2;
  std::optional<double> self_occlusion_spacing_m{};
  int num_threads = 1;  ///< Same bits for any value >= 1.
  void check() const { check_options("SurfaceEvidenceOptions", *this); }
};

inline void declare(OptionVisitor& v, SurfaceEvidenceOptions& o) {
  v.group("margin", o.margin);
  v.field("window_radius_px", o.window_radius_px, between(0, 100),
          "The nearest return within this many rows and columns of the projection counts.");
  v.field("min_viewing_cosine", o.min_viewing_cosine, between(-1, 1),
          "Points with a normal seen at a more grazing angle (78 deg) are not observed.");
  v.field(
      "self_occlusion_spacing_m", o.self_occlusion_spacing_m, positive(),
      "Spacing of the points of the surface. Points that the surface itself hides (SelfOcclusion) are occluded. off: "
      "the surface hides nothing of itself.");
  v.num_threads(o.num_threads);
}

struct SurfaceEvidence {
  std::vector<Evidence> points;
  std::vector<float> viewing_cosine;  ///< Per point: between normal and viewing ray; 1 without normals.
  std::array<int, 4> count{};         ///< By Evidence, of the points that face the camera (all points without normals).
  [[nodiscard]] int num(Evidence evidence) const { return count[static_cast<std::size_t>(evidence)]; }
};

/// Compares the depth of a surface point with a measurement of the same pixel; kUnobserved if that is NaN.
[[nodiscard]] inline Evidence compare_depth(float surface_z_m, float measured_z_m, float margin_m) {
  const float behind_m = measured_z_m - surface_z_m;
  if (std::isnan(behind_m)) return Evidence::kUnobserved;
  if (behind_m > margin_m) return Evidence::kSeenThrough;
  return behind_m < -margin_m ? Evidence::kOccluded : Evidence::kPresent;
}

/// Smallest depth within `radius_px` rows and columns of the pixel that shows a point; NaN if there is no return, the
/// pixel lies outside the image, and for z <= 0 and NaN. Taking the nearest return protects points beside an edge.
[[nodiscard]] float nearest_depth(const Eigen::Vector3f& p_in_camera, const DepthImage& view, int radius_px);

/// What the view says about one point.
[[nodiscard]] Evidence classify_point(const Eigen::Vector3f& p_in_camera, const DepthImage& view,
                                      const DepthMargin& margin, int window_radius_px = 0);

/// classify_point() for every point of a surface at a pose. Instead of the paper's spherical bins (see
/// classify_occlusion()), the depth image itself is the z-buffer: a window of 3 px is six times finer than a bin of
/// 2 deg, so that slanted surfaces do not hide themselves.
[[nodiscard]] SurfaceEvidence classify_surface(const OrientedPoints& surface, const Rigid3& camera_from_surface,
                                               const DepthImage& view, const SurfaceEvidenceOptions& options = {});

}  // namespace resight
