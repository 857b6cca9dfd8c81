// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

#include "resight/core/result.hpp"
#include "resight/geometry/lens.hpp"

namespace resight::io {

/// Focal lengths and centre in pixels. The images determine the image size.
struct Intrinsics {
  double fx = 0, fy = 0, cx = 0, cy = 0;
  friend bool operator==(const Intrinsics&, const Intrinsics&) = default;
};

/// What a file says about a camera.
struct Calibration {
  Intrinsics intrinsics;
  LensDistortion lens;
  int width = 0;                          ///< 0 if unknown.
  int height = 0;                         ///< 0 if unknown.
  std::optional<double> metres_per_unit;  ///< Of depth images.
  friend bool operator==(const Calibration&, const Calibration&) = default;
};

/// Extracts fx, fy, cx, cy from nine numbers (a camera matrix in row-major order). Fails for focal lengths that are not
/// positive, for skew, and for another last row.
[[nodiscard]] Result<Intrinsics> intrinsics_from_matrix(const std::vector<double>& matrix, std::string_view what);

/// From 4 numbers fx fy cx cy, with 4 to 8 distortion coefficients after them; or a matrix of 9 (also transposed), 12
/// or 16 numbers.
[[nodiscard]] Result<Calibration> calibration_from_numbers(const std::vector<double>& numbers, std::string_view what);

/// Reads a calibration in one of the usual forms: numbers, JSON, or lines `name: numbers` (YAML of ROS and OpenCV,
/// ini).
[[nodiscard]] Result<Calibration> read_calibration(const std::filesystem::path& file);

/// The value of --intrinsics: "fx,fy,cx,cy" (with distortion coefficients after it) or a file.
[[nodiscard]] Result<Calibration> parse_calibration(std::string_view numbers_or_file,
                                                    std::string_view option = "--intrinsics");

/// Adds what only the other one says. False if they contradict each other.
[[nodiscard]] bool complete(Calibration& calibration, const Calibration& other);

/// The calibration in a folder or in its sub-folder for intrinsics, found by name and content. None if no file holds
/// one; an error if several contradict each other, or if a file that by its name must hold one cannot be read. `source`
/// becomes the file, with the names of others that add to it.
[[nodiscard]] Result<std::optional<Calibration>> find_calibration(const std::filesystem::path& folder,
                                                                  std::filesystem::path& source);

/// Fails if the calibration is for another image size, or if its centre lies far outside the image.
[[nodiscard]] Result<void> check_calibration(const Calibration& calibration, int width, int height,
                                             std::string_view what);

}  // namespace resight::io
