// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "resight/annotation/annotation_project.hpp"
#include "resight/annotation/change_proposals.hpp"
#include "resight/annotation/refine_over_views.hpp"
#include "resight/models/object_model.hpp"

namespace resight::viewer {

/// A pose as a 4x4 matrix, column by column.
[[nodiscard]] nlohmann::ordered_json pose_json(const Rigid3& pose);
/// None unless `json` is such a matrix of a rigid motion.
[[nodiscard]] std::optional<Rigid3> parse_pose_json(const nlohmann::json& json);

/// Everything that the page shows of an annotation.
[[nodiscard]] std::string format_annotation(const AnnotationProject& project, const ModelLibrary& library,
                                            std::span<const ChangeProposal> regions);

/// Camera of a view, and the outlines of the objects that are in it, in the order of their ids.
[[nodiscard]] std::string format_annotated_view(const AnnotationDocument& document, const ModelLibrary& library,
                                                const RgbdFrame& frame, int view);

[[nodiscard]] nlohmann::ordered_json residuals_json(const std::vector<ViewResidual>& residuals);

}  // namespace resight::viewer
