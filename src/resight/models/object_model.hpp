// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "resight/features/coded_features.hpp"
#include "resight/geometry/point_cloud.hpp"
#include "resight/geometry/symmetry.hpp"

namespace resight {

/// A trained object. Everything in the object frame, metres.
struct ObjectModel {
  std::string name;    ///< Unique in its library; also the name in TUW files.
  int bop_id = 0;      ///< obj_id of BOP files, >= 1, unique in its library.
  PointCloud surface;  ///< Voxelised complete surface with normals, for verification and drawing; with colours, unless
                       ///< they are not known: then the object is recognised by its shape alone, and has no SIFT.
  CodedFeatures sift;
  CodedFeatures shot;
  ObjectSymmetries symmetries;
  ObjectSymmetries
      shape_symmetries{};  ///< Of the surface whatever its colours (shape_symmetry_motions()); none if not sought.
  Eigen::Vector3f center =
      Eigen::Vector3f::Zero();  ///< Centroid of the surface: poses are compared there, not at the origin.
  float diameter_m = 0;
};

/// All trained objects. What a recogniser is given.
struct ModelLibrary {
  std::vector<ObjectModel> objects;
  std::uint64_t options_hash = 0;                         ///< Of the training options: tells a stale library.
  float surface_voxel_m = 0.003F;                         ///< Of every object's surface.
  [[nodiscard]] int find(const std::string& name) const;  ///< Index, or -1.
};

}  // namespace resight
