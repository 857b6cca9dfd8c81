// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "resight/annotation/change_proposals.hpp"
#include "resight/sensor/sequence.hpp"

namespace resight {

/// Identifies what the proposals of a sequence depend on: names and poses of all views, pixels and cameras of up to 8
/// of them, and `settings` (version and options of the change detector, and whatever tells that the other pixels are
/// the same, such as the times of files). Fails if a view cannot be read.
[[nodiscard]] Result<std::string> digest_inputs(const Sequence& sequence, const std::string& settings);

/// Stores proposals, so that they need not be found again.
[[nodiscard]] Result<void> write_proposals(const std::filesystem::path& file, const std::string& digest,
                                           const std::vector<ChangeProposal>& proposals);

/// Proposals that were stored with this digest; none if the file is missing, damaged or of other inputs.
[[nodiscard]] std::optional<std::vector<ChangeProposal>> read_proposals(const std::filesystem::path& file,
                                                                        const std::string& digest, int num_views);

}  // namespace resight
