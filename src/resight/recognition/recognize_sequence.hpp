// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <vector>

#include "resight/core/result.hpp"
#include "resight/recognition/scene_recognizer.hpp"
#include "resight/sensor/sequence.hpp"

namespace resight {

/// Called after each view with the frame as it was read (its pose as given; `update` has the corrected one). The update
/// may be moved from.
using OnView = std::function<void(const RgbdFrame& frame, SceneUpdate& update)>;

/// Recognises all views in order and finishes the history; the last update includes the final events. Returns the
/// events per reporting view, without superseded ones: what is known at the end of the sequence. Fails with the error
/// of the first view that cannot be read. `recognizer` must not have seen a view yet. `trace`: unless null, cleared and
/// filled for each view before `on_view` is called.
[[nodiscard]] Result<std::vector<std::vector<ObjectEvent>>> recognize_sequence(SceneRecognizer& recognizer,
                                                                               const Sequence& sequence,
                                                                               const OnView& on_view = {},
                                                                               RecognitionTrace* trace = nullptr);

}  // namespace resight
