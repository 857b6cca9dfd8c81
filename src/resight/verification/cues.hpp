// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "resight/registration/correspondence.hpp"
#include "resight/verification/scene_preparation.hpp"
#include "resight/verification/visibility.hpp"

namespace resight {

/// A scene point with a weight.
struct WeightedPoint {
  int point = -1;
  float weight = 0;
};

/// What the scene says about one model point.
enum class ModelPointState : std::uint8_t { kNotVisible, kExplained, kOutlier };

/// The cues of one hypothesis, before the selection.
struct HypothesisCues {
  /// Everything that does not depend on other hypotheses. kCost: a candidate of the selection.
  HypothesisEvidence evidence;
  /// Explained scene points; those of larger planes only as far as their texture is the object's. Weights in (0, 1];
  /// ascending.
  std::vector<WeightedPoint> explained;
  std::vector<WeightedPoint> clutter;  ///< Clutter; ascending.
  std::vector<ModelPointState> state;  ///< Per model point.
};

/// Computes the cues of a model at its pose, in two steps, because the white balance of the scene is found from all
/// hypotheses together. `allowed`: per view, non-zero = the object may be present there.
///
/// The model's colours are adapted to the light of the scene (photometric_fit.hpp). Scene point q is explained with the
/// largest weight over visible model points p within t = support.max_distance_m:
///   exp(-d^2 / 2t^2) * colour(p, q) * max(0, 1 - angle(n_p, n_q) / 90 deg),
///   colour = exp(-ColorTolerance::exponent(p, q));
/// weights below 0.05 are dropped. A visible model point is an inlier when exp(-d^2 / 2(t + resolution)^2) * colour
/// exceeds support.min_weight for a scene point within t and kMaxInlierAngle_rad, and most views do not see through
/// it. Points of a plane larger than the object cost min(weight, kPlaneWeight) instead of being explained, except for
/// the share that the texture which the object shares with the plane makes its own (weigh_shared_texture()).
class CueComputer {
 public:
  /// Refines the pose, then finds the visible points, their neighbours in the scene, and the photometric fit. `model`,
  /// `scene`, `views` and `options` must outlive it.
  CueComputer(const PreparedModel& model, const Rigid3& world_from_object,
              std::span<const Correspondence> correspondences, const PreparedScene& scene,
              std::span<const DepthView> views, std::span<const std::uint8_t> allowed, const VerifyOptions& options);
  ~CueComputer();
  CueComputer(CueComputer&&) noexcept;

  /// Photometric fit of this hypothesis alone; its chromaticity is not limited.
  [[nodiscard]] const PhotometricFit& light() const;
  /// The cues under the common white balance of the scene. Hypotheses without enough evidence have no costs and explain
  /// nothing. Call it once.
  [[nodiscard]] HypothesisCues finish(const Eigen::Array3f& white_balance);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace resight
