// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>

#include "resight/verification/acceptance.hpp"

namespace resight {

/// A test that a hypothesis does not pass.
struct FailedTest {
  Verdict verdict = Verdict::kTooFewVisible;
  const char* quantity = "";  ///< What was measured, for display: "explained share".
  double value = 0;           ///< As measured.
  double limit = 0;           ///< Least value that passes; a gain must exceed it.
};

/// The first test that a verified hypothesis does not pass alone: those of assess_evidence(), then its gain. None for
/// one that was accepted, or that only another one keeps out.
[[nodiscard]] std::optional<FailedTest> find_failed_test(const HypothesisEvidence& evidence,
                                                         const AcceptanceOptions& options);

}  // namespace resight
