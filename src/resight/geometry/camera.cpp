// SPDX-License-Identifier: Apache-2.0
#include "resight/geometry/camera.hpp"

#include <cmath>

namespace resight {

bool Camera::is_valid() const {
  return width > 0 && height > 0 && std::isfinite(fx) && std::isfinite(fy) && std::isfinite(cx) && std::isfinite(cy) &&
         fx > 0 && fy > 0;
}

Camera make_kinect_camera() { return {640, 480, 525.0, 525.0, 319.5, 239.5}; }

}  // namespace resight
