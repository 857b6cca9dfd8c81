// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "resight/simulation/procedural_objects.hpp"
#include "resight/simulation/recording.hpp"

/// Recordings for tests, in the frame of the generated object.
namespace resight::test {

/// Each recording is made once.
inline std::vector<RecordedView> record(const std::string& object, double step_deg, bool upside_down = false,
                                        RecordingKind kind = RecordingKind::kTurntable) {
  static std::map<std::tuple<std::string, double, bool, RecordingKind>, std::vector<RecordedView>> made;
  const auto [entry, is_new] = made.try_emplace({object, step_deg, upside_down, kind});
  if (is_new) {
    RecordingOptions options;
    options.kind = kind;
    options.step_deg = step_deg;
    options.upside_down = upside_down;
    options.num_threads = 2;
    entry->second = simulate_recording(make_procedural_object(object)->mesh, options);
  }
  return entry->second;
}

}  // namespace resight::test
