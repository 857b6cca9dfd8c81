// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>

#include "resight/core/options.hpp"
#include "resight/evidence/surface_evidence.hpp"
#include "resight/geometry/point_cloud.hpp"
#include "resight/sensor/rgbd_frame.hpp"

namespace resight {

struct PresenceOptions {
  DepthMargin margin{};
  void check() const { check_options("PresenceOptions", *this); }
};

inline void declare(OptionVisitor& v, PresenceOptions& o) { v.group("margin", o.margin); }

/// The same without the base of the margin, which allows for errors of the pose: only the noise of the depth counts.
[[nodiscard]] inline PresenceOptions without_base(PresenceOptions options) {
  options.margin.base_m = 0;
  return options;
}

/// What one view says about an object at a place.
struct ObjectPresence {
  std::array<int, 4> count{};   ///< Surface points that face the camera, by Evidence.
  double gone_share = 0;        ///< Seen through / (seen through + present); 0 if there are none.
  bool is_informative = false;  ///< Enough of the place is seen to tell.
  bool is_gone = false;         ///< Informative, and free space where the object should be.
};

/// Compares the surface of an object at a pose with the depth of a view: classify_surface() of the points whose normal
/// faces the camera.
[[nodiscard]] ObjectPresence assess_presence(const PointCloud& surface_in_object, const Rigid3& world_from_object,
                                             const RgbdFrame& frame, const PresenceOptions& options = {});

}  // namespace resight
