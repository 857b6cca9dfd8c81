// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "resight/core/result.hpp"
#include "resight/models/object_model.hpp"

namespace resight::internal {

/// The FlatBuffers payload of a library. An error for one above the format's 2 GB.
[[nodiscard]] Result<std::vector<std::uint8_t>> encode_payload(const ModelLibrary& library);

/// The library in a payload, of which nothing is trusted: offsets, sizes, values, names and ids are checked. The errors
/// do not name the file. `options_hash` stays 0 (it is in the header).
[[nodiscard]] Result<ModelLibrary> decode_payload(std::span<const std::uint8_t> payload);

}  // namespace resight::internal
