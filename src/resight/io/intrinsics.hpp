// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string_view>

#include "resight/core/result.hpp"
#include "resight/geometry/camera.hpp"
#include "resight/geometry/lens.hpp"

namespace resight {

/// A camera with the distortion of its lens.
struct CalibratedCamera {
  Camera camera;
  LensDistortion lens;
};

/// Reads what `--intrinsics` gives, "fx,fy,cx,cy" with distortion coefficients after it, or a file, for images of
/// `width` x `height` px. Fails if they are those of images of another size.
[[nodiscard]] Result<CalibratedCamera> read_intrinsics(std::string_view numbers_or_file, int width, int height);

}  // namespace resight
