// SPDX-License-Identifier: Apache-2.0
#include "fused_cloud.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "commands.hpp"
#include "resight/core/files.hpp"
#include "resight/core/statistics.hpp"
#include "resight/geometry/splat_mesh.hpp"
#include "resight/io/images.hpp"
#include "resight/io/ply.hpp"
#include "resight/reconstruction/integration.hpp"
#include "resight/rendering/view_renderer.hpp"

namespace resight::app {
namespace {

constexpr int kMaxViews = 48;
constexpr std::size_t kMinPoints = 3;  // Of a mesh to draw.
const Camera kPictureCamera{960, 720, 820, 820, 479.5, 359.5};
// Distance of the picture's camera from the target, relative to that of the views' mean position.
constexpr double kStepBack = 1.35;

struct Fused {
  PointCloud cloud;
  Rigid3 world_from_picture;
};

// Places a camera behind the mean position of the views' cameras, looking at the mean of their targets.
Rigid3 place_picture(const std::vector<Rigid3>& cameras, const std::vector<double>& depths_m) {
  Eigen::Vector3d eye = Eigen::Vector3d::Zero(), target = eye, up = eye;
  for (std::size_t v = 0; v < cameras.size(); ++v) {
    const double share = 1.0 / static_cast<double>(cameras.size());
    eye += share * cameras[v].translation;
    target += share * (cameras[v] * Eigen::Vector3d(0, 0, depths_m[v]));
    up -= share * cameras[v].rotation.col(1);
  }
  // If the cameras surround the target, their mean lies above it, in line with `up`.
  if ((eye - target).cross(up).norm() < 1e-3) up = cameras[0].rotation.col(2);
  return look_at(target + kStepBack * (eye - target), target, up);
}

double median_depth_m(const Image<float>& depth_m) {
  std::vector<float> depths;
  for (const float z : depth_m.data())
    if (!std::isnan(z)) depths.push_back(z);
  return depths.empty() ? 1.0 : upper_median(std::move(depths));
}

Fused fuse(const Sequence& posed, int num_threads) {
  PrepareViewOptions prepare;
  prepare.max_pixels = kMaxWorkingPixels;
  prepare.num_threads = num_threads;
  IntegrateOptions integrate;
  VoxelNumbers numbers;
  std::vector<ViewVoxels> voxels;
  std::vector<Rigid3> cameras;
  std::vector<double> depths_m;
  const int num_views = std::min(posed.num_views(), kMaxViews);
  for (int k = 0; k < num_views; ++k) {
    const PreparedView view = prepare_view(value_or_throw(posed.read_view(k * posed.num_views() / num_views)), prepare);
    cameras.push_back(view.frame.world_from_camera);
    depths_m.push_back(median_depth_m(view.frame.depth_m));
    voxels.push_back(reduce_to_voxels(view, numbers, integrate));
  }
  std::vector<const ViewVoxels*> pointers;
  for (const ViewVoxels& v : voxels) pointers.push_back(&v);
  Reconstruction reconstruction;
  VoxelMerger().merge(pointers, integrate, reconstruction);
  return {std::move(reconstruction.cloud_in_world), place_picture(cameras, depths_m)};
}

Image<Rgb8> draw(const Fused& fused, int num_threads) {
  RaycastScene scene;
  SplatMeshOptions splat;
  splat.max_growth = 1.3;  // Larger isolated splats in front of the cameras would occlude the rest.
  splat.num_threads = num_threads;
  scene.add_instance(scene.add_mesh(make_splat_mesh(fused.cloud, splat)), Rigid3::identity());
  scene.commit();
  RenderOptions render;
  render.lighting.ambient = 1;  // The recorded colours already contain the illumination.
  render.lighting.diffuse = 0;
  render.background = {255, 255, 255};
  render.num_threads = num_threads;
  return render_scene(scene, kPictureCamera, fused.world_from_picture, render).color;
}

}  // namespace

void write_fused_cloud(const Sequence& posed, const std::filesystem::path& file, int num_threads) {
  const Fused fused = fuse(posed, num_threads);
  if (fused.cloud.size() < kMinPoints)
    throw InputError(file_error(file, "is not written: the views have no depth to make a point cloud of").message);
  value_or_throw(write_ply(file, fused.cloud, 1, "all views of resight track"));
  value_or_throw(write_color(picture_of_cloud(file), draw(fused, num_threads)));
}

std::filesystem::path picture_of_cloud(const std::filesystem::path& file) {
  return std::filesystem::path(file).replace_extension(".png");
}

}  // namespace resight::app
