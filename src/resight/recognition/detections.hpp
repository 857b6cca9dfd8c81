// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <deque>
#include <vector>

#include "resight/hypotheses/hypothesis.hpp"
#include "resight/recognition/recognizer_config.hpp"
#include "resight/recognition/scene_update.hpp"
#include "resight/reconstruction/dynamic_scene.hpp"

namespace resight {

/// Hypotheses as they were verified.
struct VerifiedHypotheses {
  std::vector<Hypothesis> hypotheses;        ///< World frame; clustered by the pool.
  std::vector<std::uint8_t> present;         ///< As compute_presence_mask() returns it; empty = present in all views.
  std::vector<HypothesisEvidence> evidence;  ///< One per hypothesis.
};

/// The accepted hypotheses as detections, with their scores and, per view of the window, what the view says about them;
/// without tracks. Where the current view confirms less than detections.min_reported_share by its depth, its
/// colours may confirm the object (color_confirmed_share()).
[[nodiscard]] std::vector<Detection> make_detections(const VerifiedHypotheses& verified,
                                                     const std::deque<DynamicScene::View>& window,
                                                     const ModelLibrary& library, const RecognizerConfig& config);

/// Drops the detections of which the current view itself confirms too little, and those that are too unlikely.
void drop_unlikely(std::vector<Detection>& detections, const DetectionOptions& options);

}  // namespace resight
