// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

#include "resight/appearance/lab_color.hpp"
#include "resight/geometry/block_grid.hpp"
#include "resight/geometry/point_cloud.hpp"
#include "resight/models/object_model.hpp"
#include "resight/segmentation/scene_planes.hpp"
#include "resight/verification/nearest_point_map.hpp"
#include "resight/verification/verify_options.hpp"

namespace resight {

/// The scene as all hypotheses need it, computed once. World frame.
struct PreparedScene {
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3f> normals;       ///< Empty or as long as points.
  std::vector<Eigen::Vector3f> linear_light;  ///< Empty or as long as points.
  std::vector<LabColor> lab;                  ///< Of the same colours.
  std::vector<int> segment;                   ///< Smooth segment of each point, -1 = none.
  std::vector<int> plane;                     ///< Dominant plane of each point, -1 = none.
  std::vector<ScenePlane> planes;
  int num_segments = 0;
  BlockGrid blocks;  ///< Of a few centimetres: finds the surroundings of a hypothesis.
};

/// A ball of the world.
struct Ball {
  Eigen::Vector3f center = Eigen::Vector3f::Zero();
  float radius_m = 0;
};

/// The finite points in 10 cm cubes that touch a ball (by its bounding box). Hypotheses need only their surroundings.
[[nodiscard]] PointCloud crop_to_balls(const PointCloud& cloud, std::span<const Ball> balls);

/// Downsamples the scene to resolution_m and finds its segments and planes (both need normals). Non-finite points are
/// dropped; a non-finite normal becomes zero.
[[nodiscard]] PreparedScene prepare_scene(const PointCloud& scene_in_world, const VerifyOptions& options);

/// A model as all of its hypotheses need it. Object frame.
struct PreparedModel {
  std::vector<Eigen::Vector3f> points;               ///< Downsampled to resolution_m.
  std::vector<Eigen::Vector3f> normals;              ///< Empty or as long as points.
  std::vector<Eigen::Vector3f> linear_light;         ///< Colours; empty or as long as points.
  std::vector<LabColor> lab;                         ///< The same.
  std::vector<Rigid3> symmetry_motions;              ///< shape_symmetry_motions(): by shape alone, these poses are one.
  NearestPointMap nearest;                           ///< Of the points; empty unless there are symmetry motions.
  Eigen::Vector3f center = Eigen::Vector3f::Zero();  ///< Centroid of the points.
  float diameter_m = 0;
};

/// `as_grey`: its colours as a camera without chromaticity shows them (to_grey()).
[[nodiscard]] PreparedModel prepare_model(const ObjectModel& model, const VerifyOptions& options, bool as_grey = false);

}  // namespace resight
