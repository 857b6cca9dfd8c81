// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <string>
#include <vector>

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

/// File names for the pictures of findings: `<fault>.png`, and `<fault>_2.png`, .. if several have the same fault.
[[nodiscard]] std::vector<std::string> picture_names(std::span<const Finding> findings);

}  // namespace resight
