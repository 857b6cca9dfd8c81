// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cmath>
#include <limits>
#include <vector>

#include "resight/models/object_model.hpp"
#include "resight/sensor/rgbd_frame.hpp"

namespace resight::test {

/// A world simple enough to work out by hand: square plates of side 0.2 m that face the camera, before a wall at 2 m.
inline constexpr float kHalfSide_m = 0.1F;
inline constexpr float kWall_m = 2.0F;

inline Camera small_camera() { return {160, 120, 130.0, 130.0, 79.5, 59.5}; }

/// The plate as a model: points every 4 mm in the plane z = 0, normals towards -z.
inline ObjectModel make_plate(const std::string& name) {
  ObjectModel model;
  model.name = name;
  for (int ix = -25; ix <= 25; ++ix) {
    for (int iy = -25; iy <= 25; ++iy) {
      model.surface.points.emplace_back(0.004F * static_cast<float>(ix), 0.004F * static_cast<float>(iy), 0.0F);
      model.surface.normals.emplace_back(0.0F, 0.0F, -1.0F);
      model.surface.colors.push_back({200, 30, 30});
    }
  }
  model.diameter_m = 2 * kHalfSide_m * std::sqrt(2.0F);
  return model;
}

inline Rigid3 plate_at(double x, double y, double z) { return Rigid3::from_translation({x, y, z}); }
/// Side by side, each in its half of the image.
inline const Rigid3 kLeft = plate_at(-0.3, 0, 1);
inline const Rigid3 kRight = plate_at(0.3, 0, 1);

/// What the camera at the origin sees of plates at the given poses.
inline RgbdFrame see_plates(const std::vector<Rigid3>& plates) {
  RgbdFrame frame;
  frame.name = "plates";
  frame.camera = small_camera();
  frame.color = Image<Rgb8>(frame.camera.width, frame.camera.height, {90, 90, 90});
  frame.depth_m = Image<float>(frame.camera.width, frame.camera.height, kWall_m);
  for (const Rigid3& plate : plates) {
    const double z = plate.translation.z();
    for (int v = 0; v < frame.camera.height; ++v) {
      for (int u = 0; u < frame.camera.width; ++u) {
        const Eigen::Vector3d p = frame.camera.unproject(u, v, z);
        if (std::abs(p.x() - plate.translation.x()) > kHalfSide_m ||
            std::abs(p.y() - plate.translation.y()) > kHalfSide_m)
          continue;
        if (z < frame.depth_m(u, v)) frame.depth_m(u, v) = static_cast<float>(z);
      }
    }
  }
  return frame;
}

/// Takes the returns from the columns [begin, end).
inline void hide_columns(RgbdFrame& frame, int begin, int end) {
  for (int v = 0; v < frame.depth_m.height(); ++v)
    for (int u = begin; u < end; ++u) frame.depth_m(u, v) = std::numeric_limits<float>::quiet_NaN();
}

/// The same view without a single return.
inline RgbdFrame see_nothing() {
  RgbdFrame frame = see_plates({});
  hide_columns(frame, 0, frame.depth_m.width());
  return frame;
}

}  // namespace resight::test
