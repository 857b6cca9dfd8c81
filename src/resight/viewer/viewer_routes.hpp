// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "resight/viewer/annotation_service.hpp"
#include "resight/viewer/http_message.hpp"
#include "resight/viewer/scene_data.hpp"

namespace resight {

/// The handler of the viewer: its page from memory, and under /api/ the data of a scene, addressed by number.
/// docs/viewer.md lists the addresses. With `annotation`, also what it answers, below /api/annotation. Both must
/// outlive the handler.
[[nodiscard]] HttpHandler make_viewer_handler(SceneData& scene, const std::string& token,
                                              AnnotationService* annotation = nullptr);

}  // namespace resight
