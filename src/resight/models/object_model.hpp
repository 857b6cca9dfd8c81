// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "resight/features/coded_features.hpp"
#include "resight/geometry/point_cloud.hpp"
#include "resight/geometry/symmetry.hpp"

namespace resight {

/// A trained object. All data are in the object frame, in metres.
struct ObjectModel {
  std::string name;  ///< Unique in its library. Also the name in TUW files.
  int bop_id = 0;    ///< obj_id of BOP files, >= 1, unique in its library; 0 = not assigned yet.
  /// Complete surface on a voxel grid, with normals, for verification and drawing. Without colours if they are unknown:
  /// then only training views give the object SIFT features, and without those it is recognised by its shape alone.
  PointCloud surface;
  CodedFeatures sift;
  CodedFeatures shot;
  ObjectSymmetries symmetries;
  /// Symmetries of the surface regardless of its colours (shape_symmetry_motions()); none if they were not detected.
  ObjectSymmetries shape_symmetries{};
  /// Centroid of the surface. Poses are compared there, not at the origin.
  Eigen::Vector3f center = Eigen::Vector3f::Zero();
  float diameter_m = 0;
};

/// All trained objects: the input of a recogniser.
struct ModelLibrary {
  std::vector<ObjectModel> objects;
  std::uint64_t options_hash = 0;                         ///< Hash of the training options; identifies stale libraries.
  float surface_voxel_m = 0.003F;                         ///< Voxel size of each surface.
  [[nodiscard]] int find(const std::string& name) const;  ///< Index of the object, or -1.
  [[nodiscard]] float largest_diameter_m() const;         ///< Of its objects; 0 without any.
  /// The object with this index. Throws std::invalid_argument if there is none.
  [[nodiscard]] const ObjectModel& object(int index) const;
};

}  // namespace resight
