// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <vector>

#include "change_scores.hpp"

namespace resight::bench {

/// Pictures of mistakes, on sheets of several. Each picture shows the colours before and after, and what was reported:
/// green = right, red = false, blue = missed, grey = not counted.
class PictureSheets {
 public:
  void add(const LabelledView& before, const LabelledView& after, const ChangeTruth& truth,
           const ReportedChanges& reported, const Mistake& mistake);
  /// Writes missed_01.png, ... and false_01.png, ... Creates the folder if it is missing.
  [[nodiscard]] Result<void> write(const std::filesystem::path& folder) const;

 private:
  std::vector<Image<Rgb8>> missed_;
  std::vector<Image<Rgb8>> false_;
};

}  // namespace resight::bench
