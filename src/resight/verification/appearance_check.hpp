// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "resight/models/object_model.hpp"
#include "resight/sensor/rgbd_frame.hpp"
#include "resight/verification/verify_options.hpp"

namespace resight {

/// Share of a model's points that a view confirms by colour at pixels without depth (too near, too dark, glossy).
/// 0 if fewer than 50 points are visible there, if fewer than acceptance.min_explained_share of them have the right
/// colours, if the texture differs (acceptance.min_pattern_similarity, with a nearly neutral white balance), if too
/// little of it is shared (kMinTextureContrast), or without use_color. Occlusion cannot be tested without depth:
/// occluded points are recognised only by their wrong colours.
[[nodiscard]] double color_confirmed_share(const ObjectModel& model, const Rigid3& world_from_object,
                                           const RgbdFrame& frame, const VerifyOptions& options);

}  // namespace resight
