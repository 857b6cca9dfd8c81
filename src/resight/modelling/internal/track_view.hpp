// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <span>
#include <vector>

#include "resight/modelling/track_object.hpp"

namespace resight {

/// What tracking needs of a view, cropped to the object.
struct TrackView {
  AlignmentView alignment;
  ViewFeatures features;
};

/// Crops a view to the object and some margin.
[[nodiscard]] TrainingView crop_for_tracking(const TrainingView& view);

/// The camera is that of the crop. The mask of `view` must not be empty.
[[nodiscard]] TrackView make_track_view(const TrainingView& view, const TrackObjectOptions& options);

/// Same for the chosen views, in their order.
[[nodiscard]] std::vector<TrackView> make_track_views(std::span<const TrainingView> views, std::span<const int> chosen,
                                                      const TrackObjectOptions& options);

/// Fuses all views and aligns each to the result, `rounds` times. A view keeps its pose if it would move too far or
/// lose overlap.
void refine_on_model(std::vector<TrainingView>& views, const TrackObjectOptions& options, int rounds);

/// Fused model that can be rendered from any pose.
class ModelTarget {
 public:
  ModelTarget(TriangleMesh mesh, const TrackObjectOptions& options);
  ~ModelTarget();
  ModelTarget(const ModelTarget&) = delete;
  ModelTarget& operator=(const ModelTarget&) = delete;
  /// Aligns a cropped view (make_track_view()) to the model as rendered from the given pose. `is_known`: the pose is
  /// approximately right and stays where the model does not constrain it. Thread-safe.
  [[nodiscard]] AlignedView align(const AlignmentView& view, const Camera& camera, const Rigid3& object_from_camera,
                                  bool is_known) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace resight
