// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace resight::app {

/// Whether the program was built for processors with AVX2 (and FMA). One that lacks them is refused before main().
extern const bool kNeedsAvx2;

}  // namespace resight::app
