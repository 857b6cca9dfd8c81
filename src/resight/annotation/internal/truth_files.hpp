// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "resight/annotation/annotated_events.hpp"
#include "resight/annotation/object_masks.hpp"
#include "resight/sensor/sequence.hpp"

namespace resight::annotation {

/// The text of events.json (docs/formats.md).
[[nodiscard]] std::string format_events(const std::vector<AnnotatedEvent>& events, const ModelLibrary& library,
                                        const std::string& scene, int num_views);

/// The text of scene_gt_info.json of BOP. `masks`: per view, in the order of scene_gt.json; `names`: of the views.
[[nodiscard]] std::string format_mask_info(const std::vector<std::vector<ObjectMask>>& masks,
                                           const std::vector<std::string>& names);

/// The text of `<view>.anno` of TUW.
[[nodiscard]] std::string format_anno(const std::vector<GroundTruthObject>& objects);

}  // namespace resight::annotation
