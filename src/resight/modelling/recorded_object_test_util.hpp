// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string_view>
#include <vector>

#include "resight/sensor/training_view.hpp"
#include "resight/simulation/recording.hpp"

/// Recordings for tests, in the frame of the generated object.
namespace resight::test {

inline std::vector<RecordedView> record(std::string_view object, double step_deg, bool upside_down = false,
                                        RecordingKind kind = RecordingKind::kTurntable) {
  RecordingOptions options;
  options.kind = kind;
  options.step_deg = step_deg;
  options.upside_down = upside_down;
  options.num_threads = 2;
  return simulate_recording(make_procedural_object(object)->mesh, options);
}

}  // namespace resight::test
