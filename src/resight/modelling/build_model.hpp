// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "resight/core/result.hpp"
#include "resight/features/sift.hpp"
#include "resight/geometry/symmetry.hpp"
#include "resight/modelling/coverage.hpp"
#include "resight/modelling/fusion.hpp"
#include "resight/modelling/mesh_quality.hpp"
#include "resight/training/symmetry_detection.hpp"

namespace resight {

/// What can be said of a model before anyone recognises with it.
struct ModelReport {
  int num_views = 0;
  int num_key_views = 0;
  ViewCoverage coverage;  ///< Of the key views.
  MeshHoles holes;
  Eigen::Vector3d extent_m = Eigen::Vector3d::Zero();  ///< Along the axes of the object frame.
  double diameter_m = 0;
  double keypoints_per_view = 0;  ///< SIFT on the object, median over the key views.
  double no_return_share = 0;     ///< Of the pixels within the object's outline that have no depth, over all views.
  double thin_share = 0;          ///< Of the surface that has its other side less than 5 mm behind it.
  ObjectSymmetries symmetries;    ///< Found from the surface.
  /// Where the way around the object closes, how far the first view is off; NaN = not known or it does not close.
  double closure_error_m = std::numeric_limits<double>::quiet_NaN();
  std::vector<std::string> troubles;  ///< One line each on what will be hard, and what might help.
};

/// All values are ours.
struct BuildModelOptions {
  FuseViewsOptions fuse;                 ///< Its num_threads does not count.
  double key_view_angle_rad = 0.261799;  ///< Between views that are kept for training (paper: 15 deg).
  double cloud_spacing_m = 0.002;        ///< Of the model's cloud (V4R: 2 mm).
  SiftOptions sift;
  SymmetryOptions symmetry;      ///< Its num_threads does not count.
  int min_keypoints = 40;        ///< Fewer a view: few features.
  double max_no_return = 0.08;   ///< More: shiny, dark or transparent.
  double max_thin_share = 0.15;  ///< More: thin.
  double max_open_share = 0.05;  ///< More: holes.
  double min_coverage = 0.35;    ///< Less: not seen from enough sides. Two rings of views have 0.45.
  int num_threads = 1;           ///< Same bits for any value >= 1.
  void check() const;
};

/// A model of an object, in the object frame of its views.
struct ObjectModelBuild {
  TriangleMesh mesh;           ///< Coloured at its vertices.
  PointCloud cloud;            ///< Of the mesh, with normals and colours.
  std::vector<int> key_views;  ///< Indices into the views.
  ModelReport report;
};

/// Builds a model from registered, masked views (frame.world_from_camera is object_from_camera). An error if they show
/// no surface.
[[nodiscard]] Result<ObjectModelBuild> build_model(std::span<const TrainingView> views,
                                                   const BuildModelOptions& options = {});

/// The report in lines for people.
[[nodiscard]] std::string format_report(const ModelReport& report);

}  // namespace resight
