// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "resight/geometry/triangle_mesh.hpp"
#include "resight/sensor/training_view.hpp"

namespace resight {

struct TurntableOptions {
  double step_deg = 15.0;       ///< Between neighbouring views around the object (paper: 15 deg).
  double elevation_deg = 30.0;  ///< Of the camera above the turntable.
  bool both_sides = true;       ///< Also with the object turned upside down.
  double distance_m =
      0.0;  ///< Camera to object centre; 0 = so that the object fills about half of the image height, at least 0.5 m.
  bool sensor_noise = false;  ///< Kinect noise on the views, seeded.
  std::uint64_t seed = 1;
  int num_threads = 1;
  void check() const;
};

/// Ray-casts a mesh from a ring of views at +elevation (and at -elevation for the other side). The mask contains the
/// pixels that hit the object.
[[nodiscard]] std::vector<TrainingView> render_turntable(const TriangleMesh& mesh,
                                                         const TurntableOptions& options = {});

}  // namespace resight
