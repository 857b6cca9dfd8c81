// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "resight/annotation/annotation_project.hpp"
#include "resight/annotation/change_proposals.hpp"
#include "resight/annotation/refine_over_views.hpp"
#include "resight/models/object_model.hpp"

namespace resight::viewer {

/// Everything that the page shows of an annotation.
[[nodiscard]] std::string format_annotation(const AnnotationProject& project, const ModelLibrary& library,
                                            std::span<const ChangeProposal> regions);

/// Camera of a view, and the outlines of the objects that are in it, with their ids.
[[nodiscard]] std::string format_annotated_view(const AnnotationDocument& document, const ModelLibrary& library,
                                                const RgbdFrame& frame, int view);

[[nodiscard]] nlohmann::ordered_json residuals_json(const std::vector<ViewResidual>& residuals);

}  // namespace resight::viewer
