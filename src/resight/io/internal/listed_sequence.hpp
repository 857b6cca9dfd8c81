// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "resight/io/sequence.hpp"

namespace resight::io {

enum class DepthStorage {
  kPng,         ///< 16-bit PNG.
  kRotatedPng,  ///< 16-bit PNG, each value rotated right by 3 bits.
  kNpy,         ///< float32 NumPy array in metres.
};

/// Focal lengths and centre, px; the image size is that of the images.
struct Intrinsics {
  double fx = 0, fy = 0, cx = 0, cy = 0;
};

/// A view of which all but the images is already known.
struct ListedView {
  std::string name;
  int image_id = 0;
  std::filesystem::path color;
  std::filesystem::path depth;
  Intrinsics intrinsics;
  double metres_per_unit = 0.001;  ///< Of the depth image; unused for kNpy.
  Rigid3 world_from_camera;
  std::vector<GroundTruthObject> ground_truth;
};

struct SequenceTable {
  std::string format;
  int scene_id = 0;
  bool has_poses = true;
  bool has_ground_truth = false;
  DepthStorage depth_storage = DepthStorage::kPng;
  std::vector<ListedView> views;
};

/// A sequence of separate colour and depth images: every format but TUW.
[[nodiscard]] std::unique_ptr<Sequence> make_listed_sequence(SequenceTable table);

/// fx, fy, cx, cy of nine numbers (a camera matrix, row by row). Error for focal lengths that are not positive, skew,
/// or another last row.
[[nodiscard]] Result<Intrinsics> intrinsics_from_matrix(const std::vector<double>& matrix, std::string_view what);

}  // namespace resight::io
