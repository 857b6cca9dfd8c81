// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

namespace resight {

/// Something that is wrong with a sequence, as measured.
struct Finding {
  std::string fault;    ///< Such as "depth_scale"; docs/your-camera.md lists them.
  std::string message;  ///< What is wrong, one line with the number.
  std::string remedy;   ///< What to do, with the option.
  double value = 0;
  std::string unit;      ///< Of value and threshold; empty: none.
  double threshold = 0;  ///< From here on it is a fault.
  double margin = 0;     ///< By how much value exceeds the threshold, as a factor of at least 1.
  int view = 0;          ///< A view that shows it.
};

}  // namespace resight
