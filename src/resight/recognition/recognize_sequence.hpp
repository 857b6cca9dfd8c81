// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <optional>
#include <vector>

#include "resight/core/result.hpp"
#include "resight/recognition/scene_recognizer.hpp"
#include "resight/sensor/sequence.hpp"

namespace resight {

/// Called after each view with the frame as it was read (its pose as given; `update` has the corrected one). The update
/// may be moved from.
using OnView = std::function<void(const RgbdFrame& frame, SceneUpdate& update)>;

/// Measures the errors of the camera (measure_camera_errors()), recognises all views in order and finishes the history;
/// the last update includes the final events. Returns the events per reporting view, without superseded ones: what is
/// known at the end of the sequence. Fails with the error of the first view that cannot be read. `recognizer` must not
/// have seen a view yet. `trace`: unless null, cleared and filled for each view before `on_view` is called.
[[nodiscard]] Result<std::vector<std::vector<ObjectEvent>>> recognize_sequence(SceneRecognizer& recognizer,
                                                                               const Sequence& sequence,
                                                                               const OnView& on_view = {},
                                                                               RecognitionTrace* trace = nullptr);

/// The next view of a source whose end is not known, such as a camera; none at its end.
using NextView = std::function<Result<std::optional<RgbdFrame>>()>;

/// Same for such a source. Events that were waiting for a further view are reported at the last one, but only in the
/// returned lists. Fails with the error of `next`. `trace` as above.
[[nodiscard]] Result<std::vector<std::vector<ObjectEvent>>> recognize_views(SceneRecognizer& recognizer,
                                                                            const NextView& next,
                                                                            const OnView& on_view = {},
                                                                            RecognitionTrace* trace = nullptr);

}  // namespace resight
