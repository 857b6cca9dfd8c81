// SPDX-License-Identifier: Apache-2.0
#include "resight/io/intrinsics.hpp"

#include "resight/io/internal/calibration.hpp"

namespace resight {

Result<CalibratedCamera> read_intrinsics(std::string_view numbers_or_file, int width, int height) {
  const auto given = io::parse_calibration(numbers_or_file);
  if (!given) return given.error();
  if (const auto fits = io::check_calibration(*given, width, height, "--intrinsics"); !fits) return fits.error();
  const io::Intrinsics& k = given->intrinsics;
  return CalibratedCamera{{width, height, k.fx, k.fy, k.cx, k.cy}, given->lens};
}

}  // namespace resight
