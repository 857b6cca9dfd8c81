// SPDX-License-Identifier: Apache-2.0
#include "resight/verification/hypothesis_evidence.hpp"

namespace resight {

const char* to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::kAccepted:
      return "accepted";
    case Verdict::kTooFewVisible:
      return "too few visible";
    case Verdict::kNoSupport:
      return "no support";
    case Verdict::kDifferentAppearance:
      return "different appearance";
    case Verdict::kSuppressed:
      return "suppressed";
    case Verdict::kCost:
      return "cost";
  }
  return "unknown";
}

}  // namespace resight
