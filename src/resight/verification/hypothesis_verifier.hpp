// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "resight/hypotheses/hypothesis.hpp"
#include "resight/models/object_model.hpp"
#include "resight/verification/hypothesis_evidence.hpp"
#include "resight/verification/scene_preparation.hpp"
#include "resight/verification/verify_options.hpp"

namespace resight {

/// Chooses the set of hypotheses that explains the scene best (binary cost of [11], local search with activate,
/// deactivate and replace moves). `present`: views x hypotheses (view-major), non-zero where the change detection says
/// that the object may be present; empty = everywhere. A model point counts as visible if one allowed view sees it (its
/// own back and self-occluded parts do not count). Scene and views in the world frame.
///
/// Minimises J = -( E - r Out - Dup - Clut - w Occ - Plane ). Deviations from V4R, each covered by a test: small
/// components are solved exactly; planes are always active and count only if larger than the object; Occ is summed over
/// pairs, without voxels in which the normals oppose (contact). Without colours, shape alone is compared; without
/// normals, distance and colour. Throws std::invalid_argument for bad options, a null view, a wrong size of `present`,
/// an unknown object or a pose that is not rigid. Non-finite scene points are ignored.
[[nodiscard]] VerifyResult verify_hypotheses(std::span<const Hypothesis> hypotheses, const ModelLibrary& library,
                                             const PointCloud& scene_in_world, std::span<const VerificationView> views,
                                             std::span<const std::uint8_t> present, const VerifyOptions& options = {});

/// verify_hypotheses() for many views: what hypotheses need of a model is made once, when the first asks for it, and
/// kept. One call at a time.
class HypothesisVerifier {
 public:
  /// `library` must outlive it, and stay as it is. Throws std::invalid_argument for bad options.
  explicit HypothesisVerifier(const ModelLibrary& library, const VerifyOptions& options = {});

  /// As verify_hypotheses(), and throws as it does.
  [[nodiscard]] VerifyResult verify(std::span<const Hypothesis> hypotheses, const PointCloud& scene_in_world,
                                    std::span<const VerificationView> views, std::span<const std::uint8_t> present);

 private:
  void prepare_models(std::span<const Hypothesis> hypotheses, bool as_grey);

  const ModelLibrary& library_;
  VerifyOptions options_;
  std::vector<PreparedModel> models_;  // Empty until needed.
  bool models_are_grey_ = false;
};

}  // namespace resight
