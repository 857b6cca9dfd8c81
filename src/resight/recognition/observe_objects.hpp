// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <vector>

#include "resight/models/object_model.hpp"
#include "resight/models/observed_object.hpp"
#include "resight/recognition/scene_update.hpp"
#include "resight/sensor/sequence.hpp"

namespace resight {

/// Called after each view.
using ObserveProgress = std::function<void(int view, const SceneUpdate& update)>;

/// Recognises each view of a sequence by itself (preset `default`, K = 0). Camera poses are not used. Fails with the
/// error of the first view that cannot be read.
[[nodiscard]] Result<std::vector<ObservedObject>> observe_objects(const Sequence& sequence, const ModelLibrary& library,
                                                                  int num_threads,
                                                                  const ObserveProgress& progress = {});

}  // namespace resight
