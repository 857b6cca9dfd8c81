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

/// Quality of a model, measured before it is used for recognition.
struct ModelReport {
  int num_views = 0;
  int num_key_views = 0;
  ViewCoverage coverage;  ///< Coverage by the key views.
  MeshHoles holes;
  Eigen::Vector3d extent_m = Eigen::Vector3d::Zero();  ///< Size along the axes of the object frame.
  double diameter_m = 0;
  double keypoints_per_view = 0;  ///< SIFT keypoints on the object; median over the key views.
  /// Share of pixels within the object's outline without depth, over all views.
  double no_return_share = 0;
  double thin_share = 0;        ///< Share of the surface with its other side less than 5 mm behind it.
  ObjectSymmetries symmetries;  ///< Detected from the surface.
  /// Error of the first view at the surface where the track around the object closes; NaN = unknown, or it does not
  /// close.
  double closure_error_m = std::numeric_limits<double>::quiet_NaN();
  /// One line per expected difficulty, with a remedy where there is one.
  std::vector<std::string> troubles;
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
  TriangleMesh mesh;           ///< With vertex colours.
  PointCloud cloud;            ///< Sampled from the mesh, with normals and colours.
  std::vector<int> key_views;  ///< Ascending indices of the views.
  ModelReport report;
};

/// Builds a model from registered, masked views (frame.world_from_camera is object_from_camera). Fails if they show no
/// surface.
[[nodiscard]] Result<ObjectModelBuild> build_model(std::span<const TrainingView> views,
                                                   const BuildModelOptions& options = {});

/// Formats the report as text.
[[nodiscard]] std::string format_report(const ModelReport& report);

}  // namespace resight
