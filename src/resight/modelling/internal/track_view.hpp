// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <span>
#include <vector>

#include "resight/modelling/track_object.hpp"

namespace resight {

/// What tracking needs of a view: the object alone, cut out of the image.
struct TrackView {
  AlignmentView alignment;
  ViewFeatures features;
};

/// The object and some pixels around it.
[[nodiscard]] TrainingView crop_for_tracking(const TrainingView& view);

/// With the camera of the cut-out; the mask of `view` must hold a pixel.
[[nodiscard]] TrackView make_track_view(const TrainingView& view, const TrackObjectOptions& options);

/// The same of some of the views.
[[nodiscard]] std::vector<TrackView> make_track_views(std::span<const TrainingView> views, std::span<const int> chosen,
                                                      const TrackObjectOptions& options);

/// Aligns every view to the fused whole, `rounds` times; their poses are changed. Those that would move far or lose
/// their hold stay.
void refine_on_model(std::vector<TrainingView>& views, const TrackObjectOptions& options, int rounds);

/// The fused views, to be seen from anywhere.
class ModelTarget {
 public:
  ModelTarget(TriangleMesh mesh, const TrackObjectOptions& options);
  ~ModelTarget();
  ModelTarget(const ModelTarget&) = delete;
  ModelTarget& operator=(const ModelTarget&) = delete;
  /// Aligns a view (cut out, see make_track_view()) to what of the model would be seen from the pose. `is_known`: the
  /// pose is about right and stays where the model leaves it open. Thread-safe.
  [[nodiscard]] AlignedView align(const AlignmentView& view, const Camera& camera, const Rigid3& object_from_camera,
                                  bool is_known) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace resight
