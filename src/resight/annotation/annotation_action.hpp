// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "resight/annotation/annotation_document.hpp"

namespace resight {

/// Changes that belong together: they are applied all or none, and undone together.
struct AnnotationEdit {
  std::string title;  ///< What the user did, at most 200 bytes.
  std::vector<AnnotationChange> changes;
};
struct UndoEdit {};
struct RedoEdit {};
using AnnotationAction = std::variant<AnnotationEdit, UndoEdit, RedoEdit>;

/// An action as one line of JSON: "undo", "redo", or {"title": .., "changes": [..]} (docs/annotate.md). Poses are 4x4
/// matrices, column by column, in metres.
[[nodiscard]] std::string format_action(const AnnotationAction& action);

/// Reads what format_action() writes. Poses that deviate by up to 0.01 per element from a rigid motion are repaired.
/// Fails for other JSON, no changes, and numbers that are not finite. Numbers of views and objects are
/// checked by apply_change().
[[nodiscard]] Result<AnnotationAction> parse_action(std::string_view text);

}  // namespace resight
