// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <deque>

#include "resight/core/options.hpp"
#include "resight/registration/view_alignment.hpp"

namespace resight {

struct CorrectCameraOptions {
  bool fixed = false;
  bool correct = false;
  int num_views = 8;
  double sigma_m = 0.01;
  double sigma_rad = 0.0175;
  double min_overlap = 0.2;
  double max_distance_m = 0.05;
  int num_threads = 1;  ///< Same bits for any value >= 1.
  void check() const { check_options("CorrectCameraOptions", *this); }
};

inline void declare(OptionVisitor& v, CorrectCameraOptions& o) {
  v.field(
      "fixed", o.fixed,
      "The camera does not move: poses are not corrected, and a view with the pose of the one before is never suspect. "
      "'--poses fixed' and '--camera' set this.",
      "ours");
  v.field("correct", o.correct, "Given camera poses are corrected by alignment to the views before.", "ours");
  v.only_if(o.correct, "correct", "true", [&] {
    v.field("num_views", o.num_views, at_least(1), "A view is aligned to this many views before it.");
    v.field("sigma_m", o.sigma_m, positive(), "Standard deviation of given motions between views.");
    v.field("sigma_rad", o.sigma_rad, positive(), "Standard deviation of given rotations between views (1 deg).");
    v.field(
        "min_overlap", o.min_overlap, between(0, 1),
        "A view with a smaller share in common with those before is not aligned; it follows the last one that was.");
    v.field("max_distance_m", o.max_distance_m, positive(),
            "Largest distance of a pair of points at the coarsest level of the alignment.");
  });
  v.num_threads(o.num_threads);
}

/// By how much the given pose of a camera is off.
struct PoseCorrection {
  bool is_measured = false;  ///< The views before show where the camera is.
  double moved_m = 0;        ///< Between given and corrected pose; 0 if the given one is kept.
  double moved_rad = 0;
  double sigma_m = 0;  ///< Standard error of the measured pose, root mean square over the three axes.
  double sigma_rad = 0;
};

struct CorrectedCamera {
  Rigid3 world_from_camera;  ///< As given, or corrected.
  PoseCorrection correction;
};

/// Corrects given camera poses view by view. Each view is aligned to the preceding views at their corrected
/// poses, from its given pose and from the given motion since the last view that was aligned: the poses of a tracker
/// drift. Robust weights keep changed regions from pulling. A pose that agrees with its alignment, within what the
/// surfaces tell, is returned unchanged, bit for bit. A camera whose given pose does not change keeps its corrected
/// pose, bit for bit, unless another one fits clearly better. A view that cannot be aligned keeps its given motion
/// since the last one that was.
class CameraCorrector {
 public:
  explicit CameraCorrector(const CorrectCameraOptions& options = {});

  /// Corrects the pose of a view (with normals) and keeps the view as a target for the next ones.
  CorrectedCamera add_view(const PreparedView& view);

 private:
  struct View {
    AlignmentView view;
    Rigid3 world_from_camera;
    Rigid3 given;
    bool is_measured = false;
  };
  [[nodiscard]] const View& last_known() const;
  [[nodiscard]] Rigid3 predict(const Rigid3& given) const;
  [[nodiscard]] CorrectedCamera correct(const AlignmentView& view, const Rigid3& given) const;
  [[nodiscard]] PoseCorrection measure(const AlignedView& aligned) const;
  [[nodiscard]] bool is_too_far(const AlignedView& aligned, const Rigid3& start) const;
  /// Whether the surfaces tell each direction clearly better than the given pose does.
  [[nodiscard]] bool is_constrained(const AlignedView& aligned) const;
  [[nodiscard]] bool is_surprising(const AlignedView& aligned, const Rigid3& world_from_camera) const;

  CorrectCameraOptions options_;
  AlignViewOptions align_;
  std::deque<View> views_;
};

}  // namespace resight
