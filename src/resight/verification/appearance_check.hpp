// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "resight/models/object_model.hpp"
#include "resight/sensor/rgbd_frame.hpp"
#include "resight/verification/verify_options.hpp"

namespace resight {

/// Of the points of a model, the share that a view shows in the colours of its print where its depth image has no
/// return (too near, black, glossy): a sensor that is blind there still has eyes. 0 where less than 50 points are seen
/// so, where less than min_explained_share of them have the right colours or their print is not alike
/// (AcceptanceOptions::min_pattern_similarity) under light that is about white, where it shares too little contrast to
/// tell (UntexturedOptions::max_shared_contrast), and without use_color. What hides the object, or is hidden by itself
/// but faces the camera, is known by its other colours only.
[[nodiscard]] double color_confirmed_share(const ObjectModel& model, const Rigid3& world_from_object,
                                           const RgbdFrame& frame, const VerifyOptions& options);

}  // namespace resight
