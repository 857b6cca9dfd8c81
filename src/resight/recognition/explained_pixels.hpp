// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>

#include "resight/core/image.hpp"
#include "resight/evidence/object_presence.hpp"
#include "resight/history/tracked_object.hpp"
#include "resight/models/object_model.hpp"

namespace resight {

/// The pixels (255, others 0) whose depth is that of a tracked object at its place, within presence.margin.base_m:
/// thinner things that lie on it are explained with it. An object explains no pixels if the view sees too little of its
/// place, or more than a tenth of it free (ObjectPresence::gone_share).
[[nodiscard]] Image<std::uint8_t> find_explained_pixels(const RgbdFrame& frame, std::span<const TrackedObject> tracked,
                                                        const ModelLibrary& library,
                                                        const PresenceOptions& presence = {});

}  // namespace resight
