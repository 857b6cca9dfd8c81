// SPDX-License-Identifier: Apache-2.0
#include "resight/recognition/recognize_sequence.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "resight/sensor/read_ahead.hpp"

namespace resight {

Result<std::vector<std::vector<ObjectEvent>>> recognize_sequence(SceneRecognizer& recognizer, const Sequence& sequence,
                                                                 const OnView& on_view, RecognitionTrace* trace) {
  std::vector<std::vector<ObjectEvent>> events;
  const int num_views = sequence.num_views();
  StageTimes calibration;
  {
    const ScopedTimer timer(calibration, "calibration");
    const RecognizerConfig& config = recognizer.config();
    recognizer.set_camera_errors(
        measure_camera_errors(sequence, config.prepare, config.camera.color_offset, config.camera.depth_bias));
  }
  ReadAhead reader(sequence, recognizer.config().verify.num_threads);
  for (int v = 0; v < num_views; ++v) {
    const Result<RgbdFrame> frame = reader.read_view(v);
    if (!frame) return frame.error();
    if (trace != nullptr) *trace = {};
    SceneUpdate update = recognizer.add_view(*frame, trace);
    if (v == 0) update.times.add(calibration);
    if (v + 1 == num_views) std::ranges::move(recognizer.finish(), std::back_inserter(update.events));
    events.push_back(update.events);
    if (on_view) on_view(*frame, update);
  }
  drop_superseded(events);
  return events;
}

Result<std::vector<std::vector<ObjectEvent>>> recognize_views(SceneRecognizer& recognizer, const NextView& next,
                                                              const OnView& on_view, RecognitionTrace* trace) {
  std::vector<std::vector<ObjectEvent>> events;
  for (;;) {
    const Result<std::optional<RgbdFrame>> frame = next();
    if (!frame) return frame.error();
    if (!*frame) break;
    if (trace != nullptr) *trace = {};
    SceneUpdate update = recognizer.add_view(**frame, trace);
    events.push_back(update.events);
    if (on_view) on_view(**frame, update);
  }
  if (!events.empty()) std::ranges::move(recognizer.finish(), std::back_inserter(events.back()));
  drop_superseded(events);
  return events;
}

}  // namespace resight
