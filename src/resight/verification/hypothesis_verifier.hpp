// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "resight/verification/scene_preparation.hpp"
#include "resight/verification/verify_options.hpp"

namespace resight {

/// verify_hypotheses() for many views: what hypotheses need of a model is made once, when the first asks for it, and
/// kept. One call at a time.
class HypothesisVerifier {
 public:
  /// `library` must outlive it, and stay as it is. Throws std::invalid_argument for bad options.
  explicit HypothesisVerifier(const ModelLibrary& library, VerifyOptions options = {});

  /// As verify_hypotheses(), and throws as it does.
  [[nodiscard]] VerifyResult verify(std::span<const Hypothesis> hypotheses, const PointCloud& scene_in_world,
                                    std::span<const VerificationView> views, std::span<const std::uint8_t> present);

 private:
  void prepare_models(std::span<const Hypothesis> hypotheses);

  const ModelLibrary& library_;
  VerifyOptions options_;
  std::vector<PreparedModel> models_;  // Empty until needed.
};

}  // namespace resight
