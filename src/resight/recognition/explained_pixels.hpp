// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>

#include "resight/core/image.hpp"
#include "resight/evidence/object_presence.hpp"
#include "resight/history/tracked_object.hpp"
#include "resight/models/object_model.hpp"

namespace resight {

/// The pixels (255, others 0) whose depth is that of a known object at its place, within presence.margin.base_m: what
/// is thinner and lies on it is explained with it. An object of which the view sees too little to tell, or more than a
/// tenth free (ObjectPresence::gone_share), explains none.
[[nodiscard]] Image<std::uint8_t> find_explained_pixels(const RgbdFrame& frame, std::span<const TrackedObject> known,
                                                        const ModelLibrary& library,
                                                        const PresenceOptions& presence = {});

}  // namespace resight
