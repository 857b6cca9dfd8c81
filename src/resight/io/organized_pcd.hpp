// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <span>
#include <string_view>

#include "resight/io/pcd.hpp"
#include "resight/sensor/rgbd_frame.hpp"

namespace resight {

/// Fewer points do not determine a camera.
inline constexpr int kMinPointsForCamera = 100;
/// Largest root mean square deviation of the points from the pixel grid of a pinhole camera.
inline constexpr double kMaxCameraResidual_px = 1.0;

/// A fitted camera with the quality of the fit.
struct CameraFit {
  Camera camera;
  double residual_px = 0;  ///< Root mean square over the points and both axes.
  int num_points = 0;
};

/// Fits a pinhole camera to an organised cloud by least squares of u = fx x/z + cx and v = fy y/z + cy over all points
/// with z > 0. None for fewer than kMinPointsForCamera points, or if these lie in one row or column.
[[nodiscard]] std::optional<CameraFit> fit_camera(std::span<const Eigen::Vector3f> points, int width, int height);

/// Rotation from the optical frame (z forward) to the frame of the points: the identity, or a half turn about x if all
/// points lie behind the camera. Such clouds have x right, y up, z backward, as in OpenGL and the first Kinect
/// recordings of PCL.
[[nodiscard]] Rigid3 find_points_from_camera(std::span<const Eigen::Vector3f> points);

/// Converts an organised cloud to an RGB-D view: depth = z, colour per pixel, pose = viewpoint. Points with NaN or
/// without positive z become missing depth; a cloud with only negative z is rotated first (find_points_from_camera()).
/// The camera is that of the comment in the file, else that of fit_camera(). Fails if the points do not lie on a
/// pinhole grid. If there are too few points, the camera has f = 525 px and its centre in the middle of the image.
[[nodiscard]] Result<RgbdFrame> to_frame(const PcdCloud& cloud, std::string_view name);

/// Converts a view to an organised cloud with its camera. to_frame() restores the same view bit for bit.
[[nodiscard]] PcdCloud to_pcd_cloud(const RgbdFrame& frame);

}  // namespace resight
