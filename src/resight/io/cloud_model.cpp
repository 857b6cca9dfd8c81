// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "resight/io/internal/files.hpp"
#include "resight/io/internal/model_files.hpp"
#include "resight/io/mesh.hpp"
#include "resight/io/organized_pcd.hpp"
#include "resight/io/ply.hpp"

namespace resight::io {
namespace {

/// Points outside the image would be lost. A larger share of them indicates another camera or another frame.
constexpr double kMaxOutsideShare = 0.05;
/// A single view cannot have a larger share of points behind others than this. "Behind" means by more than this
/// multiple of an image cell that contains about four points (on a surface at 80 deg incidence, depth changes by six
/// cells per cell).
constexpr double kMaxHiddenShare = 0.1;
constexpr double kHiddenBehindCells = 8.0;

TrainingView empty_view(const Camera& camera) {
  TrainingView view;
  view.frame.camera = camera;
  view.frame.color = Image<Rgb8>(camera.width, camera.height);
  view.frame.depth_m = Image<float>(camera.width, camera.height, std::numeric_limits<float>::quiet_NaN());
  view.mask = Image<std::uint8_t>(camera.width, camera.height, 0);
  return view;
}

/// Points in an image: u, v in pixels, and z in metres.
using ImagePoints = std::vector<Eigen::Vector3d>;

/// Projects the points into the image of the camera, in their order. None if the cloud is not in front of it.
std::optional<ImagePoints> project(const PointCloud& cloud, const Camera& camera, const Rigid3& camera_from_points) {
  ImagePoints projected;
  std::size_t num_outside = 0;
  for (const Eigen::Vector3f& point : cloud.points) {
    const Eigen::Vector3d p = camera_from_points * point.cast<double>();
    const Eigen::Vector2d pixel = p.z() > 0 ? camera.project(p) : Eigen::Vector2d(-1, -1);
    num_outside += camera.contains(pixel) ? 0 : 1;
    projected.emplace_back(pixel.x(), pixel.y(), p.z());
  }
  if (static_cast<double>(num_outside) > kMaxOutsideShare * static_cast<double>(cloud.size())) return std::nullopt;
  return projected;
}

/// Whether points lie behind others. This is the case for a cloud of all sides of an object, but not for a single view.
bool hides_itself(const ImagePoints& points, const Camera& camera) {
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector3d& p : points)
    if (camera.contains(p.head<2>())) box.extend(p.head<2>());
  const double cell_px = std::max(2.0, 2 * std::sqrt(box.volume() / static_cast<double>(points.size())));
  const auto columns = static_cast<std::size_t>(camera.width / cell_px) + 2;
  std::vector<double> nearest_m(columns * (static_cast<std::size_t>(camera.height / cell_px) + 2), 1e9);
  const auto cell_of = [&](const Eigen::Vector3d& p) {
    return static_cast<std::size_t>((p.y() + 0.5) / cell_px) * columns +
           static_cast<std::size_t>((p.x() + 0.5) / cell_px);
  };
  for (const Eigen::Vector3d& p : points)
    if (camera.contains(p.head<2>())) nearest_m[cell_of(p)] = std::min(nearest_m[cell_of(p)], p.z());
  std::size_t num_hidden = 0;
  for (const Eigen::Vector3d& p : points) {
    if (!camera.contains(p.head<2>())) continue;
    const double cell_m = cell_px * p.z() / camera.fx;
    if (p.z() - nearest_m[cell_of(p)] > kHiddenBehindCells * cell_m) ++num_hidden;
  }
  return static_cast<double>(num_hidden) > kMaxHiddenShare * static_cast<double>(points.size());
}

/// Draws the nearest point of each pixel.
TrainingView draw(const PointCloud& cloud, const ImagePoints& points, const Camera& camera) {
  TrainingView view = empty_view(camera);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const std::optional<Pixel> pixel = camera.pixel_at(points[i].head<2>());
    if (!pixel) continue;
    const auto [u, v] = *pixel;
    const auto z = static_cast<float>(points[i].z());
    float& depth_m = view.frame.depth_m(u, v);
    if (depth_m <= z) continue;  // false for NaN
    depth_m = z;
    if (cloud.has_colors()) view.frame.color(u, v) = cloud.colors[i];
    view.mask(u, v) = 255;
  }
  return view;
}

/// Converts points to a single view if possible, else to the whole surface.
Result<ModelSource> model_of_points(PointCloud cloud, const fs::path& file) {
  if (cloud.empty()) return file_error(file, "holds no points");
  if (const auto done = check_size(cloud.points, {}, file); !done) return done.error();
  ModelSource model;
  const Camera camera = make_kinect_camera();
  const Rigid3 points_from_camera = find_points_from_camera(cloud.points);
  const auto points = project(cloud, camera, points_from_camera.inverse());
  if (points && !hides_itself(*points, camera)) {
    model.views.push_back(draw(cloud, *points, camera));
    model.views[0].frame.world_from_camera = points_from_camera;
  } else {
    model.surface = clean_normals(std::move(cloud));
  }
  return model;
}

Result<ModelSource> model_of_grid(const PcdCloud& cloud, const fs::path& file) {
  auto frame = to_frame(cloud, file.string());
  if (!frame) return frame.error();
  frame->world_from_camera = find_points_from_camera(cloud.points);  // the object frame is that of the points
  TrainingView view = empty_view(frame->camera);
  for (std::size_t i = 0; i < view.mask.size(); ++i) view.mask[i] = std::isnan(frame->depth_m[i]) ? 0 : 255;
  view.frame = std::move(*frame);
  ModelSource model;
  model.views.push_back(std::move(view));
  return model;
}

Result<ModelSource> read_points(const fs::path& file, double metres_per_unit) {
  if (extension_of(file) == "pcd") {
    auto pcd = read_pcd(file);
    if (!pcd) return pcd.error();
    for (Eigen::Vector3f& p : pcd->points) p *= static_cast<float>(metres_per_unit);
    return pcd->is_organized() ? model_of_grid(*pcd, file) : model_of_points(to_point_cloud(*pcd), file);
  }
  auto cloud = read_ply_cloud(file, metres_per_unit);
  if (!cloud) return cloud.error();
  return model_of_points(std::move(*cloud), file);
}

}  // namespace

Result<ModelSource> read_cloud_model(const fs::path& file, const std::string& name, double metres_per_unit) {
  auto model = read_points(file, metres_per_unit);
  if (!model) return model;
  model->name = name;
  for (TrainingView& view : model->views) {
    view.frame.name = file.stem().string();
    if (const auto done = check_frame(view.frame); !done) return file_error(file, done.error().message);
    if (count_valid(view.frame.depth_m) == 0) return file_error(file, "holds no points");
  }
  return model;
}

}  // namespace resight::io
