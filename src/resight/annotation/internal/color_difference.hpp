// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>

#include "resight/annotation/internal/sampled_surface.hpp"
#include "resight/evidence/surface_evidence.hpp"
#include "resight/sensor/rgbd_frame.hpp"

namespace resight {

/// Mean absolute difference of the colours of a surface and of a view, at the points that are present, after the light
/// was fitted per channel; 1 is half of the range of a channel. None without colours or without such points.
[[nodiscard]] std::optional<double> color_difference(const SampledSurface& surface, const SurfaceEvidence& evidence,
                                                     const Rigid3& camera_from_object, const RgbdFrame& frame);

}  // namespace resight
