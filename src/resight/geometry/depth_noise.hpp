// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace resight {

/// The noise model of a depth camera. At the depth z (m) and the angle theta between surface normal and viewing ray,
/// with r = theta / (pi/2 - theta), the standard deviations are
///   axial   = constant_m + quadratic_per_m (z - nearest_m)^2 + grazing r^2 / sqrt(z)  metres, along z,
///   lateral = lateral_px + lateral_grazing_px r                                       pixels, in the image.
/// The default is that of structured light: Kinect v1 by Nguyen, Izadi and Lovell 2012 (paper [19]).
struct DepthNoise {
  double constant_m = 0.0012;
  double quadratic_per_m = 0.0019;
  double nearest_m = 0.4;
  double grazing = 0.0001;
  double lateral_px = 0.8;
  double lateral_grazing_px = 0.035;
  friend bool operator==(const DepthNoise&, const DepthNoise&) = default;
};

}  // namespace resight
