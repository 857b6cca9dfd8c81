// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <memory>

#include "resight/core/result.hpp"
#include "resight/evaluation/change_truth.hpp"
#include "resight/evaluation/evaluated_run.hpp"
#include "resight/recognition/recognizer_config.hpp"
#include "resight/recognition/view_hypotheses.hpp"
#include "resight/sensor/sequence.hpp"

namespace resight {

struct EvaluateSequenceOptions {
  MatchDetectionsOptions match;
  bool find_losses = true;  ///< Look for the stage at which each missed object was lost.
  /// Hypotheses that other runs over the same views have made, or this one makes for them; null = made here.
  std::shared_ptr<ViewHypothesisStore> hypotheses;
  /// Called after each view, with its number.
  std::function<void(int, const EvaluatedView&)> progress;
};

/// Recognises every view of a sequence in order and scores it against its own ground truth. Sets all fields of the run
/// except `sequence`, `fingerprint` and `num_threads`. Fails with the error of the first view that cannot be read.
/// Throws std::invalid_argument unless `truth.views` has one entry per view.
[[nodiscard]] Result<EvaluatedRun> evaluate_sequence(const Sequence& sequence, const SequenceTruth& truth,
                                                     const ModelLibrary& library, const RecognizerConfig& config,
                                                     const EvaluateSequenceOptions& options = {});

}  // namespace resight
