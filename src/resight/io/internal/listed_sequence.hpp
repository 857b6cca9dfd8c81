// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "resight/io/sequence.hpp"

namespace resight::io {

/// Encoding of depth images.
enum class DepthStorage {
  kPng,         ///< 16-bit PNG.
  kRotatedPng,  ///< 16-bit PNG, each value rotated right by 3 bits.
  kNpy,         ///< float32 NumPy array in metres.
};

/// Focal lengths and centre in pixels. The images determine the image size.
struct Intrinsics {
  double fx = 0, fy = 0, cx = 0, cy = 0;
};

/// A view without its images; everything else is already known.
struct ListedView {
  std::string name;
  int image_id = 0;
  std::filesystem::path color;
  std::filesystem::path depth;
  Intrinsics intrinsics;
  double metres_per_unit = 0.001;  ///< Unit of the depth image; unused for kNpy.
  Rigid3 world_from_camera;
  std::vector<GroundTruthObject> ground_truth;
};

/// All views of a sequence with its common properties.
struct SequenceTable {
  std::string format;
  int scene_id = 0;
  bool has_poses = true;
  bool has_ground_truth = false;
  DepthStorage depth_storage = DepthStorage::kPng;
  std::vector<ListedView> views;
};

/// A sequence of separate colour and depth images, which all formats except TUW use.
[[nodiscard]] std::unique_ptr<Sequence> make_listed_sequence(SequenceTable table);

/// Extracts fx, fy, cx, cy from nine numbers (a camera matrix in row-major order). Fails for focal lengths that are not
/// positive, for skew, and for another last row.
[[nodiscard]] Result<Intrinsics> intrinsics_from_matrix(const std::vector<double>& matrix, std::string_view what);

}  // namespace resight::io
