// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "resight/core/result.hpp"

namespace resight::io {

/// What the files of a series hold, by the header of its first file.
enum class SeriesKind { kColor, kDepth, kPose, kOther };

/// One file of a series.
struct SeriesFile {
  std::filesystem::path file;
  std::string name;  ///< The file name up to its last number that differs: "frame-000012.color.jpg" -> "frame-000012".
  double time_s = std::numeric_limits<double>::quiet_NaN();  ///< If the name is a time.
};

/// Files whose names differ in their numbers only, or images of one kind whose names have no number.
struct FileSeries {
  std::filesystem::path folder;
  std::string pattern;  ///< File name with # for each number, such as "frame-#.depth.png", or "*.png".
  SeriesKind kind = SeriesKind::kOther;
  /// By the numbers that differ, or by the name. Whole numbers are without leading zeros.
  std::map<std::string, SeriesFile> files;
  [[nodiscard]] std::string label() const;  ///< For messages: folder and pattern.
};

/// A colour image with its depth image.
struct ImagePair {
  SeriesFile color;
  SeriesFile depth;
  std::string key;  ///< Of the colour image in its series.
};

/// Colour and depth series of a folder, paired.
struct PairedSeries {
  FileSeries color;
  FileSeries depth;
  std::vector<ImagePair> pairs;  ///< In the order of the names.
};

/// The series in a folder and in those of its sub-folders whose names say that they hold images, poses or intrinsics.
/// If no images are there, those in sub-folders of any name that hold only colour or only depth.
[[nodiscard]] std::vector<FileSeries> find_series(const std::filesystem::path& folder);

/// Finds the colour and the depth series that belong together. None if there are none; an error if several are equally
/// good.
[[nodiscard]] Result<std::optional<PairedSeries>> pair_series(const std::vector<FileSeries>& all,
                                                              const std::filesystem::path& folder);

/// One sentence about what images are there, for an error message. Empty if there are none.
[[nodiscard]] std::string describe_images(const std::vector<FileSeries>& all);

}  // namespace resight::io
