// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "resight/core/result.hpp"
#include "resight/models/object_model.hpp"

namespace resight::internal {

/// The largest payload: offsets in FlatBuffers have 31 bits.
inline constexpr std::uint64_t kMaxPayloadBytes = (std::uint64_t{1} << 31) - 1;

/// Encodes a library as FlatBuffers payload. Fails if the payload exceeds the 2 GB of the format.
[[nodiscard]] Result<std::vector<std::uint8_t>> encode_payload(const ModelLibrary& library);

/// Decodes the library in an untrusted payload: checks offsets, sizes, values, names and ids. Errors do not name the
/// file. `options_hash` stays 0 (it is in the header).
[[nodiscard]] Result<ModelLibrary> decode_payload(std::span<const std::uint8_t> payload);

}  // namespace resight::internal
