// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "resight/core/random.hpp"
#include "resight/rendering/sensor_model.hpp"
#include "resight/simulation/camera_drift.hpp"

namespace resight {

// Devices and rooms as they are used in practice. Each draw is one device or one room; what changes from view to view
// is in the drawn options. docs/benchmark.md compares the results with real recordings.

/// A depth camera with structured light and its colour camera, after factory calibration.
[[nodiscard]] SensorOptions draw_sensor(Rng& rng);
/// The distortion of the colour camera that its calibration leaves.
[[nodiscard]] ResidualDistortion draw_lens(Rng& rng);
/// Two lamps under the ceiling, one warm and one cold, that cast soft shadows, and ambient light.
[[nodiscard]] Lighting draw_lighting(Rng& rng);
/// A tracker of camera poses.
[[nodiscard]] CameraDriftOptions draw_drift(Rng& rng);

}  // namespace resight
