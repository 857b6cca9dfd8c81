// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "resight/geometry/camera.hpp"
#include "resight/inspection/depth_values.hpp"
#include "resight/inspection/finding.hpp"

/// Faults of single views; each function adds those that it finds.
namespace resight::inspection {

void add_depth_faults(const DepthValues& depth, double noise_ratio, int view, std::vector<Finding>& findings);
void add_color_faults(double bright_grey, int view, std::vector<Finding>& findings);
void add_camera_faults(const Camera& camera, int view, std::vector<Finding>& findings);
/// `distance_m`: of the camera from the origin of the world.
void add_origin_fault(double distance_m, int view, std::vector<Finding>& findings);

}  // namespace resight::inspection
