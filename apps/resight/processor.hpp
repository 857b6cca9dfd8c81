// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace resight::app {

/// Whether the program was compiled for processors with AVX2 (and FMA). Other processors are rejected before main().
extern const bool kNeedsAvx2;

}  // namespace resight::app
