// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

#include "resight/core/image.hpp"
#include "resight/core/result.hpp"
#include "resight/geometry/camera.hpp"
#include "resight/geometry/point_cloud.hpp"
#include "resight/geometry/rigid3.hpp"

namespace resight {

/// Contents of a point cloud file: `width` x `height` points in row-major order (height 1 = unorganised), metres,
/// camera frame. `normals` and `colors` are empty or as long as `points`. NaN (or all zeros, see to_frame()) means no
/// point.
struct PcdCloud {
  int width = 0;
  int height = 0;
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3f> normals;
  std::vector<Rgb8> colors;
  Rigid3 viewpoint;              ///< world_from_camera, from the VIEWPOINT of the header.
  std::optional<Camera> camera;  ///< From our own comment line "# camera fx fy cx cy".

  [[nodiscard]] bool is_organized() const { return height > 1; }
};

/// WIDTH and HEIGHT of a PCD header.
struct PcdSize {
  int width = 0;
  int height = 0;
};

/// DATA of a PCD header.
enum class PcdEncoding { kAscii, kBinary, kBinaryCompressed };

/// Reads ascii, binary and binary_compressed PCD with fields in any order and of any SIZE, TYPE and COUNT. Requires x y
/// z; reads rgb or rgba (packed into a float or an integer) and normal_x normal_y normal_z; skips other fields. Checks
/// the header against the size of the file before anything is allocated.
[[nodiscard]] Result<PcdCloud> read_pcd(const std::filesystem::path& file);
/// Same from memory. `name` is used in error messages.
[[nodiscard]] Result<PcdCloud> parse_pcd(std::string_view bytes, std::string_view name);
/// Reads only the size from the header.
[[nodiscard]] Result<PcdSize> read_pcd_size(const std::filesystem::path& file);

/// Writes x y z, rgb and normals if the cloud has them, VIEWPOINT, and the camera as a comment. Ascii preserves all
/// digits.
[[nodiscard]] Result<void> write_pcd(const std::filesystem::path& file, const PcdCloud& cloud,
                                     PcdEncoding encoding = PcdEncoding::kBinaryCompressed);

/// The finite points with their attributes, in file order (camera frame; the viewpoint is not applied).
[[nodiscard]] PointCloud to_point_cloud(const PcdCloud& cloud);
/// Converts a cloud to unorganised file contents.
[[nodiscard]] PcdCloud to_pcd_cloud(const PointCloud& cloud);

}  // namespace resight
