// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cmath>

#include "resight/core/check.hpp"
#include "resight/models/object_model.hpp"

namespace resight {

/// Some points of a model's surface; object frame.
struct SampledSurface {
  PointCloud cloud;
  double spacing_m = 0;  ///< About the distance of neighbours.
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  double radius_m = 0.05;  ///< Half the diameter.
};

/// Every n-th point of the surface, at most about `max_points`.
inline SampledSurface sample_surface_evenly(const ObjectModel& model, double surface_voxel_m, int max_points) {
  require(model.surface.has_normals(), "the model '" + model.name + "' has no surface with normals");
  const auto step =
      (model.surface.size() + static_cast<std::size_t>(max_points) - 1) / static_cast<std::size_t>(max_points);
  std::vector<int> chosen;
  for (std::size_t i = 0; i < model.surface.size(); i += step) chosen.push_back(static_cast<int>(i));
  SampledSurface sampled;
  sampled.cloud = select(model.surface, chosen);
  sampled.spacing_m = 1.5 * surface_voxel_m * std::sqrt(static_cast<double>(step));
  sampled.middle = model.center.cast<double>();
  sampled.radius_m = std::max(0.01, 0.5 * static_cast<double>(model.diameter_m));
  return sampled;
}

}  // namespace resight
