// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "resight/annotation/change_proposals.hpp"

namespace resight {

/// Identifies what the proposals of a sequence depend on: the pixels, cameras and poses of all views, and `settings`
/// (version and options of the change detector). Reads every view. Fails if one cannot be read.
[[nodiscard]] Result<std::string> digest_inputs(const Sequence& sequence, const std::string& settings);

/// Stores proposals, so that they need not be found again.
[[nodiscard]] Result<void> write_proposals(const std::filesystem::path& file, const std::string& digest,
                                           const std::vector<ChangeProposal>& proposals);

/// Proposals that were stored with this digest; none if the file is missing, damaged or of other inputs.
[[nodiscard]] std::optional<std::vector<ChangeProposal>> read_proposals(const std::filesystem::path& file,
                                                                        const std::string& digest, int num_views);

}  // namespace resight
