// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace resight {

/// Lets the allocator of the process keep what is freed, instead of giving it back to the system: each view needs as
/// many large arrays as the last, and their pages would be cleared anew (a tenth of the CPU time of a view). For
/// programs that recognise for a while; it has no effect without the GNU C library. Call it before anything large is
/// allocated. Returns whether the allocator will.
bool keep_freed_memory();

}  // namespace resight
