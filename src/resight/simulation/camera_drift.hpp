// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "resight/core/options.hpp"
#include "resight/geometry/rigid3.hpp"

namespace resight {

/// Error of a camera tracker: a random walk that loop closures pull back, so that it neither grows for ever nor jumps.
struct CameraDriftOptions {
  double position_sigma_m = 0;
  double rotation_sigma_deg = 0;
  double correlation_views = 6;
  std::uint64_t seed = 1;
  void check() const { check_options("CameraDriftOptions", *this); }
};

inline void declare(OptionVisitor& v, CameraDriftOptions& o) {
  v.field("position_sigma_m", o.position_sigma_m, between(0, 1),
          "Sigma of the error of the camera's position per axis after many views; 0: exact.",
          "5 to 15 mm for RGB-D SLAM in one room, Sturm et al. 2012, Mur-Artal and Tardos 2017");
  v.field("rotation_sigma_deg", o.rotation_sigma_deg, between(0, 20),
          "Sigma of the error of the camera's rotation per axis after many views; 0: exact.",
          "0.2 to 0.5 deg, Sturm et al. 2012");
  v.field("correlation_views", o.correlation_views, positive(),
          "Number of views after which 37 % of an error is left: 0.2 is independent noise, 100 a random walk.");
  v.field("seed", o.seed, "Of the errors.");
}

/// What a tracker with drift reports for a camera on this path. The error of the first view is zero: it defines the
/// world.
[[nodiscard]] std::vector<Rigid3> drift_poses(std::span<const Rigid3> world_from_camera,
                                              const CameraDriftOptions& options);

}  // namespace resight
