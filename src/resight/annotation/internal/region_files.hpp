// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <span>

#include "resight/annotation/annotation_document.hpp"
#include "resight/annotation/change_proposals.hpp"
#include "resight/annotation/view_store.hpp"
#include "resight/models/object_model.hpp"

namespace resight::annotation {

/// Writes the accepted regions to `folder`: regions.json and a mask each, as proposed or as corrected by hand
/// (docs/annotate.md). Fails if a view cannot be read.
[[nodiscard]] Result<void> write_regions(const AnnotationDocument& document, std::span<const ChangeProposal> proposals,
                                         const ModelLibrary& library, ViewStore& views,
                                         const std::filesystem::path& folder);

}  // namespace resight::annotation
