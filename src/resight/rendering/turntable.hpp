// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "resight/core/options.hpp"
#include "resight/geometry/triangle_mesh.hpp"
#include "resight/sensor/training_view.hpp"

namespace resight {

struct TurntableOptions {
  double step_deg = 15.0;
  double elevation_deg = 30.0;
  bool both_sides = true;
  double distance_m = 0.0;
  bool sensor_noise = false;
  std::uint64_t seed = 1;
  int num_threads = 1;
  void check() const { check_options("TurntableOptions", *this); }
};

inline void declare(OptionVisitor& v, TurntableOptions& o) {
  v.field("step_deg", o.step_deg, between(1, 360), "Angle between neighbouring views around the object.", "paper");
  v.field("elevation_deg", o.elevation_deg, between(0, 85), "Elevation of the camera above the turntable.");
  v.field("both_sides", o.both_sides, "Views are also made of the object turned upside down.");
  v.field(
      "distance_m", o.distance_m, at_least(0),
      "Distance of the camera from the object's centre. 0: the object fills about half of the image height, at least "
      "0.5.");
  v.field("sensor_noise", o.sensor_noise, "The views have the noise of a Kinect.");
  v.field("seed", o.seed, "Of the noise.");
  v.num_threads(o.num_threads);
}

/// Ray-casts a mesh from a ring of views at +elevation (and at -elevation for the other side). The mask contains the
/// pixels that hit the object.
[[nodiscard]] std::vector<TrainingView> render_turntable(const TriangleMesh& mesh,
                                                         const TurntableOptions& options = {});

}  // namespace resight
