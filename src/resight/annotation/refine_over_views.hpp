// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <vector>

#include "resight/models/object_model.hpp"
#include "resight/sensor/rgbd_frame.hpp"

namespace resight {

/// What the depth of one view says of an object at a pose.
struct ViewResidual {
  int view = 0;
  int num_visible = 0;           ///< Surface points that the view observes: present or seen through.
  double supported_share = 0;    ///< Present over visible, within 15 mm and the noise; 0 if nothing is visible.
  double median_distance_m = 0;  ///< Of the supported points to the measured surface, along their normals.
  bool is_informative = false;   ///< Enough is visible to tell.
  bool is_gone = false;          ///< Informative, and free space where the object should be.
  bool is_used = false;          ///< Takes part in the refinement.
};

/// A view and its number in the sequence.
struct NumberedView {
  int number = 0;
  const RgbdFrame* frame = nullptr;
};

struct RefineOverViewsOptions {
  double max_distance_m = 0.03;   ///< Of the first pairs; the gate shrinks from here to `min_distance_m`.
  double min_distance_m = 0.006;  ///< Of the last pairs, along the normal.
  int max_points = 2500;          ///< Surface points used.
  int max_iterations = 60;        ///< Per fit.
  bool fit_twice = true;          ///< Also from nearer pairs, so that a good start is not lost to what is nearby.
  void check() const;
};

struct RefinedPlacement {
  Rigid3 world_from_object;
  std::vector<ViewResidual> views;  ///< At the refined pose, in the order of the given views.
  int num_pairs = 0;                ///< Of the last iteration, over all views.
};

/// Assesses a pose in each view without moving it.
[[nodiscard]] std::vector<ViewResidual> assess_views(const ObjectModel& model, double surface_voxel_m,
                                                     const Rigid3& world_from_object,
                                                     std::span<const NumberedView> views);

/// Moves an object so that its surface lies on the measured surface of all views together: projective point-to-plane
/// ICP with the normals of the model, Tukey's weights, and the noise of the sensor as unit. The camera poses are
/// trusted. Views that see through the object take no part: it is not there. Directions that no view determines stay as
/// they are. Of two fits and the given pose, the one that the views support best counts. Deterministic. Throws
/// std::invalid_argument if a view is null or the model has no normals.
[[nodiscard]] RefinedPlacement refine_over_views(const ObjectModel& model, double surface_voxel_m,
                                                 const Rigid3& world_from_object, std::span<const NumberedView> views,
                                                 const RefineOverViewsOptions& options = {});

}  // namespace resight
