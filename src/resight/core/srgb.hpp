// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace resight {

/// Encodes a value of 0..1 with the curve of sRGB, as 0..255, and back.
[[nodiscard]] float encode_srgb(float linear);
[[nodiscard]] float decode_srgb(float encoded_255);

}  // namespace resight
