// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <memory>
#include <string>

#include "resight/sensor/depth_sensor.hpp"
#include "resight/sensor/sequence.hpp"

namespace resight::io {

/// The same sequence. `adjust` is applied to each frame after it is read, and `note` is added to the notes.
[[nodiscard]] std::unique_ptr<Sequence> with_adjusted_frames(std::unique_ptr<Sequence> sequence,
                                                             std::function<void(RgbdFrame&)> adjust, std::string note);
/// The same sequence, whose views have the noise of a kind of depth camera. `reason`: for the note.
[[nodiscard]] std::unique_ptr<Sequence> with_sensor(std::unique_ptr<Sequence> sequence, const DepthSensor& sensor,
                                                    const std::string& reason);

}  // namespace resight::io
