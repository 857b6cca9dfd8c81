// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "resight/verification/verify_options.hpp"

namespace resight {

/// Whether the evidence is enough to ask for the costs (kCost), or else why not. Of what shares no contrast with the
/// scene more is asked (UntexturedOptions).
[[nodiscard]] Verdict judge_evidence(const HypothesisEvidence& evidence, const VerifyOptions& options);

/// Whether it may enter the choice: its verdict is kCost, and if must_pay_alone, it explains more than it costs; what
/// is plain, by UntexturedOptions::min_gain.
[[nodiscard]] bool has_unary_gain(const HypothesisEvidence& evidence, const VerifyOptions& options);

}  // namespace resight
