// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <string>

#include "resight/sensor/depth_sensor.hpp"
#include "resight/sensor/sequence.hpp"

namespace resight::io {

/// The same sequence, whose views have the noise of a kind of depth camera. `reason`: for the note.
[[nodiscard]] std::unique_ptr<Sequence> with_sensor(std::unique_ptr<Sequence> sequence, const DepthSensor& sensor,
                                                    const std::string& reason);

}  // namespace resight::io
