// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>

#include "resight/io/sequence.hpp"

namespace resight::app {

/// Writes all views of a sequence with poses (of a long one, some, evenly) as one cloud (PLY, world frame, metres), and
/// a picture of it beside it (.png), from above the cameras.
void write_fused_cloud(const Sequence& posed, const std::filesystem::path& file, int num_threads);

}  // namespace resight::app
