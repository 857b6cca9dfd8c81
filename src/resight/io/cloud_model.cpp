// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <limits>

#include "resight/io/internal/files.hpp"
#include "resight/io/internal/model_files.hpp"
#include "resight/io/organized_pcd.hpp"
#include "resight/io/ply.hpp"

namespace resight::io {
namespace {

/// A point that misses the image would be lost; more than this share of them means another camera or another frame.
constexpr double kMaxOutsideShare = 0.05;

TrainingView empty_view(const Camera& camera) {
  TrainingView view;
  view.frame.camera = camera;
  view.frame.color = Image<Rgb8>(camera.width, camera.height);
  view.frame.depth_m = Image<float>(camera.width, camera.height, std::numeric_limits<float>::quiet_NaN());
  view.mask = Image<std::uint8_t>(camera.width, camera.height, 0);
  return view;
}

/// The nearest point of each pixel. None if the cloud is not in front of the camera.
std::optional<TrainingView> project(const PointCloud& cloud, const Camera& camera) {
  TrainingView view = empty_view(camera);
  view.frame.world_from_camera = find_points_from_camera(cloud.points);
  const Rigid3 camera_from_points = view.frame.world_from_camera.inverse();
  std::size_t num_outside = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Eigen::Vector3d p = camera_from_points * cloud.points[i].cast<double>();
    const Eigen::Vector2d pixel = p.z() > 0 ? camera.project(p) : Eigen::Vector2d(-1, -1);
    if (!camera.contains(pixel)) {
      ++num_outside;
      continue;
    }
    const int u = static_cast<int>(pixel.x() + 0.5);
    const int v = static_cast<int>(pixel.y() + 0.5);
    float& depth_m = view.frame.depth_m(u, v);
    if (depth_m <= static_cast<float>(p.z())) continue;  // false for NaN
    depth_m = static_cast<float>(p.z());
    view.frame.color(u, v) = cloud.colors[i];
    view.mask(u, v) = 255;
  }
  if (static_cast<double>(num_outside) > kMaxOutsideShare * static_cast<double>(cloud.size())) return std::nullopt;
  return view;
}

Result<TrainingView> view_of_points(const PointCloud& cloud, const fs::path& file) {
  if (cloud.empty()) return file_error(file, "holds no points");
  if (!cloud.has_colors())
    return file_error(file, "has points without colours and without faces; expected a mesh, or a coloured cloud");
  if (const auto done = check_size(cloud.points, {}, file); !done) return done.error();
  auto view = project(cloud, make_kinect_camera());
  if (!view)
    return file_error(file,
                      "is a cloud that no 640x480 camera of 525 px at its origin sees; expected a mesh, or the cloud "
                      "of one view in its camera frame");
  return std::move(*view);
}

Result<TrainingView> view_of_grid(const PcdCloud& cloud, const fs::path& file) {
  auto frame = to_frame(cloud, file.string());
  if (!frame) return frame.error();
  frame->world_from_camera = find_points_from_camera(cloud.points);  // the object's frame is that of its points
  TrainingView view = empty_view(frame->camera);
  for (std::size_t i = 0; i < view.mask.size(); ++i) view.mask[i] = std::isnan(frame->depth_m[i]) ? 0 : 255;
  view.frame = std::move(*frame);
  return view;
}

Result<TrainingView> read_view(const fs::path& file) {
  if (extension_of(file) == "pcd") {
    const auto pcd = read_pcd(file);
    if (!pcd) return pcd.error();
    return pcd->is_organized() ? view_of_grid(*pcd, file) : view_of_points(to_point_cloud(*pcd), file);
  }
  const auto cloud = read_ply_cloud(file);
  if (!cloud) return cloud.error();
  return view_of_points(*cloud, file);
}

}  // namespace

Result<ModelSource> read_cloud_model(const fs::path& file, const std::string& name) {
  auto view = read_view(file);
  if (!view) return view.error();
  view->frame.name = file.stem().string();
  if (const auto done = check_frame(view->frame); !done) return file_error(file, done.error().message);
  if (count_valid(view->frame.depth_m) == 0) return file_error(file, "holds no points");
  ModelSource model;
  model.name = name;
  model.views.push_back(std::move(*view));
  return model;
}

}  // namespace resight::io
