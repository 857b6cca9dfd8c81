// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <span>
#include <string>

#include "resight/annotation/annotation_document.hpp"
#include "resight/annotation/change_proposals.hpp"
#include "resight/annotation/view_store.hpp"
#include "resight/models/object_model.hpp"

namespace resight {

struct ExportSummary {
  int num_views = 0;
  int num_objects = 0;  ///< Over all views.
  int num_events = 0;
};

/// Fails if there is anything but an earlier export.
[[nodiscard]] Result<void> check_export_folder(const std::filesystem::path& folder);

/// Writes an annotation as ground truth to `folder`, which replaces an earlier export there as a whole:
/// bop/<scene>/ (a BOP scene with its views, masks and events.json) and tuw/<scene>/ with tuw/<scene>.changes (poses of
/// TUW in both styles, for the views as they are named in the sequence), and regions/ (the accepted ones of `proposals`
/// with their masks). Listed are the objects of which at least one pixel is in the image. Fails if a view cannot be
/// read, or the folder holds anything else.
[[nodiscard]] Result<ExportSummary> export_annotation(const AnnotationDocument& document, const ModelLibrary& library,
                                                      std::span<const ChangeProposal> proposals, ViewStore& views,
                                                      const std::string& scene, const std::filesystem::path& folder);

}  // namespace resight
