// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <span>
#include <string_view>

#include "resight/io/pcd.hpp"
#include "resight/sensor/rgbd_frame.hpp"

namespace resight {

/// Fewer points than this say nothing about the camera.
inline constexpr int kMinPointsForCamera = 100;
/// Largest root mean square deviation of the points from the pixel grid of a pinhole camera.
inline constexpr double kMaxCameraResidual_px = 1.0;

struct CameraFit {
  Camera camera;
  double residual_px = 0;  ///< Root mean square over the points and both axes.
  int num_points = 0;
};

/// The pinhole camera of an organised cloud, by least squares from u = fx x/z + cx and v = fy y/z + cy over all its
/// points (z > 0). None with fewer than kMinPointsForCamera points, or if they lie in one row or column.
[[nodiscard]] std::optional<CameraFit> fit_camera(std::span<const Eigen::Vector3f> points, int width, int height);

/// The rotation that turns the optical frame (z forward) into the frame of the points: the identity, or half a turn
/// about x where no point lies before and all lie behind the camera. Such clouds have x right, y up, z backward, as
/// OpenGL and the first Kinect recordings of PCL.
[[nodiscard]] Rigid3 find_points_from_camera(std::span<const Eigen::Vector3f> points);

/// The RGB-D view that an organised cloud is: depth = z, colour of every pixel, pose = viewpoint. A point that is NaN,
/// or has no positive z, is no return; a cloud with all z negative is turned (find_points_from_camera()). The camera is
/// the one of the file's comment; else fit_camera(), with an error when the points do not lie on a pinhole grid; else
/// (next to no points) f = 525 px and the centre of the image.
[[nodiscard]] Result<RgbdFrame> to_frame(const PcdCloud& cloud, std::string_view name);

/// The organised cloud of a view, with its camera, so that to_frame() gives back the same view bit by bit.
[[nodiscard]] PcdCloud to_pcd_cloud(const RgbdFrame& frame);

}  // namespace resight
