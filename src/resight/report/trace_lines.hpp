// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <string>

#include "resight/models/object_model.hpp"
#include "resight/recognition/recognition_trace.hpp"
#include "resight/recognition/scene_update.hpp"
#include "resight/sensor/sequence.hpp"
#include "resight/verification/acceptance.hpp"

namespace resight {

/// A line lists at most so many hypotheses: what was accepted, what missed objects were lost with, and of the others
/// those that fit best.
inline constexpr std::size_t kMaxTracedHypotheses = 200;

/// What the stages did at one view.
struct TracedView {
  const SceneUpdate* update = nullptr;
  const RecognitionTrace* trace = nullptr;
  std::span<const GroundTruthObject> missed;  ///< True objects of the library that were not found.
  const AcceptanceOptions* acceptance = nullptr;
};

/// The first line of the file, without a line break.
[[nodiscard]] std::string format_trace_header(const std::string& preset, const std::string& version);

/// One view as one line of JSON, without a line break (docs/formats.md): its hypotheses after clustering with their
/// evidence, their verdict and the test that they failed, and the stage at which each missed object was lost
/// (find_loss()).
[[nodiscard]] std::string format_trace_line(const TracedView& view, const ModelLibrary& library);

}  // namespace resight
