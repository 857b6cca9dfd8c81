// SPDX-License-Identifier: Apache-2.0
#include "pcl_votes.hpp"

#include <pcl/features/shot_lrf.h>
#include <pcl/recognition/cg/hough_3d.h>

#include "../cpu_clock.hpp"
#include "pcl_clouds.hpp"

namespace resight::bench::pcl_peers {
namespace {

using Frames = pcl::PointCloud<pcl::ReferenceFrame>;

Frames::Ptr local_frames(const XyzCloud::Ptr& keypoints, Points surface, float radius_m) {
  Frames::Ptr frames(new Frames);
  pcl::SHOTLocalReferenceFrameEstimation<pcl::PointXYZ, pcl::ReferenceFrame> estimation;
  estimation.setInputCloud(keypoints);
  estimation.setSearchSurface(make_cloud(surface));
  estimation.setRadiusSearch(radius_m);
  estimation.compute(*frames);
  return frames;
}

bool has_frame(const pcl::ReferenceFrame& frame) { return std::isfinite(frame.x_axis[0]); }

}  // namespace

Timed<std::vector<Pose>> group_by_votes(Points model_xyz, Points scene_xyz, std::span<const float> distances,
                                        Points model_surface, Points scene_surface, float frame_radius_m, float bin_m,
                                        int min_group_size) {
  const XyzCloud::Ptr model = make_cloud(model_xyz);
  const XyzCloud::Ptr scene = make_cloud(scene_xyz);
  const Frames::Ptr model_frames = local_frames(model, model_surface, frame_radius_m);
  const Frames::Ptr scene_frames = local_frames(scene, scene_surface, frame_radius_m);
  pcl::CorrespondencesPtr pairs(new pcl::Correspondences);
  for (std::size_t i = 0; i < distances.size(); ++i)
    if (has_frame((*model_frames)[i]) && has_frame((*scene_frames)[i]))
      pairs->emplace_back(static_cast<int>(i), static_cast<int>(i), distances[i]);
  std::vector<Eigen::Matrix4f, Eigen::aligned_allocator<Eigen::Matrix4f>> found;
  if (pairs->empty()) return {};
  const CpuClock clock;
  pcl::Hough3DGrouping<pcl::PointXYZ, pcl::PointXYZ, pcl::ReferenceFrame, pcl::ReferenceFrame> grouping;
  grouping.setHoughBinSize(bin_m);
  grouping.setHoughThreshold(min_group_size);
  grouping.setUseInterpolation(true);
  grouping.setUseDistanceWeight(false);
  grouping.setInputCloud(model);
  grouping.setInputRf(model_frames);
  grouping.setSceneCloud(scene);
  grouping.setSceneRf(scene_frames);
  grouping.setModelSceneCorrespondences(pairs);
  grouping.recognize(found);
  const double cpu_s = clock.elapsed_s();
  std::vector<Pose> poses;
  for (const Eigen::Matrix4f& scene_from_object : found) poses.push_back(to_pose(scene_from_object));
  return {std::move(poses), cpu_s};
}

}  // namespace resight::bench::pcl_peers
