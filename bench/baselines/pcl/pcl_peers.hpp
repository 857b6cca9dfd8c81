// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#define RESIGHT_PCL_PEER __attribute__((visibility("default")))

/// PCL's implementation of the recognition stages behind an interface of plain arrays. PCL is built for the compiler's
/// default instruction set, for which Eigen aligns its types differently than for ours: no type of Eigen or PCL may
/// cross this interface.
///
/// Points are x, y, z in sequence, in metres; NaN = no measurement. One thread. `cpu_s` is the time of PCL's calls,
/// including search trees unless stated otherwise, but without copies into its types.
namespace resight::bench::pcl_peers {

template <typename T>
struct Timed {
  T value;
  double cpu_s = 0;
};

using Points = std::span<const float>;
/// Rigid motion: three rows of four.
using Pose = std::array<float, 12>;

/// Image of points, row by row.
struct OrganizedPoints {
  Points xyz;
  int width = 0;
  int height = 0;
};

struct OrientedPoints {
  Points xyz;
  Points normals;
};

/// pcl::VoxelGrid: the mean of each cube.
RESIGHT_PCL_PEER Timed<std::vector<float>> voxel_grid(Points points, float leaf_m);
/// pcl::UniformSampling: the point nearest to the centre of each cube.
RESIGHT_PCL_PEER Timed<std::vector<float>> uniform_sampling(Points points, float spacing_m);

enum class NeighborSearch : std::uint8_t { kKdTree, kOrganized };
/// pcl::NormalEstimationOMP over all neighbours within the radius: one normal per pixel, towards the camera.
RESIGHT_PCL_PEER Timed<std::vector<float>> normals_by_radius(OrganizedPoints view, float radius_m,
                                                             NeighborSearch search);

enum class IntegralImageMethod : std::uint8_t { kCovariance, kAverageGradient };
/// pcl::IntegralImageNormalEstimation.
RESIGHT_PCL_PEER Timed<std::vector<float>> normals_by_integral_image(OrganizedPoints view, IntegralImageMethod method,
                                                                     float max_depth_change, float window_px);

/// pcl::SHOTEstimationOMP: 352 values per keypoint, all NaN if it has no descriptor.
RESIGHT_PCL_PEER Timed<std::vector<float>> describe_shot(Points keypoints, OrientedPoints support, float radius_m);

/// pcl::KdTreeFLANN over SHOT descriptors: the index of the nearest one per query. The time includes the search only.
RESIGHT_PCL_PEER Timed<std::vector<int>> nearest_shot(std::span<const float> indexed, std::span<const float> queries);

/// pcl::GeometricConsistencyGrouping of the correspondences of one object, model_xyz[i] with scene_xyz[i]. Returns
/// poses scene_from_object.
RESIGHT_PCL_PEER Timed<std::vector<Pose>> group_correspondences(Points model_xyz, Points scene_xyz,
                                                                std::span<const float> distances, float consistency_m,
                                                                int min_group_size);

struct VerifyOptions {
  float resolution_m = 0.005F;
  float inlier_distance_m = 0.01F;
  float occlusion_margin_m = 0.01F;
  float clutter_radius_m = 0.03F;
  float clutter_regularizer = 5.0F;
  float regularizer = 3.0F;
  float normal_radius_m = 0.02F;
};
/// pcl::GlobalHypothesesVerification in one view with f = 525 px and the image centre as principal point (it supports
/// no other). `models`: surface of each hypothesis at its pose, camera frame. Returns whether each is accepted.
RESIGHT_PCL_PEER Timed<std::vector<std::uint8_t>> verify_hypotheses(OrganizedPoints view,
                                                                    std::span<const std::vector<float>> models,
                                                                    const VerifyOptions& options);

/// Moved points and their initial pose scene_from_object.
struct RefinementTask {
  std::vector<float> xyz;
  std::vector<float> normals;
  Pose start;
};
enum class IcpKind : std::uint8_t { kPointToPoint, kPointToPlane };
/// pcl::IterativeClosestPoint(WithNormals) of each task onto the scene. The search tree is built before timing starts.
RESIGHT_PCL_PEER Timed<std::vector<Pose>> refine_poses(OrientedPoints scene, std::span<const RefinementTask> tasks,
                                                       IcpKind kind, float max_distance_m, int max_iterations);

/// pcl::getPointCloudDifference: indices of the points of `a` without a point of `b` within the tolerance.
RESIGHT_PCL_PEER Timed<std::vector<int>> point_cloud_difference(Points a, Points b, float tolerance_m);
/// pcl::octree::OctreePointCloudChangeDetector: indices of the points of `a` in voxels without points of `b`.
RESIGHT_PCL_PEER Timed<std::vector<int>> octree_difference(Points a, Points b, float voxel_m);

}  // namespace resight::bench::pcl_peers
