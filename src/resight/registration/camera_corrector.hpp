// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <deque>
#include <optional>

#include "resight/core/options.hpp"
#include "resight/registration/view_alignment.hpp"

namespace resight {

struct CorrectCameraOptions {
  bool correct = false;
  int num_views = 3;
  double sigma_m = 0.01;
  double sigma_rad = 0.0175;
  double min_overlap = 0.2;
  double max_distance_m = 0.05;
  std::optional<double> brightness_sigma = 12;
  int num_threads = 1;  ///< Same bits for any value >= 1.
  void check() const { check_options("CorrectCameraOptions", *this); }
};

inline void declare(OptionVisitor& v, CorrectCameraOptions& o) {
  v.field("correct", o.correct, "Given camera poses are corrected by alignment to the views before.", "ours");
  v.only_if(o.correct, "correct", "true", [&] {
    v.field("num_views", o.num_views, at_least(1), "A view is aligned to this many views before it.");
    v.field("sigma_m", o.sigma_m, positive(), "Standard deviation of given positions.");
    v.field("sigma_rad", o.sigma_rad, positive(), "Standard deviation of given rotations (1 deg).");
    v.field("min_overlap", o.min_overlap, between(0, 1),
            "With a smaller share of the view in common with those before, the given pose stays.");
    v.field("max_distance_m", o.max_distance_m, positive(), "Largest distance of a pair at the coarsest level.");
    v.field("brightness_sigma", o.brightness_sigma, positive(),
            "Standard deviation of brightness, in grey levels. off: depth alone.", "Steinbruecker et al. 2011");
  });
  v.num_threads(o.num_threads);
}

/// Corrects given camera poses view by view. Each view is aligned to the preceding views at their corrected poses.
/// Robust weights keep changed regions from pulling. A pose that agrees with its alignment is returned unchanged, bit
/// for bit.
class CameraCorrector {
 public:
  explicit CameraCorrector(const CorrectCameraOptions& options = {});

  /// Returns the corrected world_from_camera of a view (with normals) and keeps the view as a target for the next ones.
  Rigid3 add_view(const PreparedView& view);

 private:
  struct View {
    AlignmentView view;
    Rigid3 world_from_camera;
  };
  [[nodiscard]] Rigid3 correct(const AlignmentView& view, const Rigid3& world_from_camera) const;
  [[nodiscard]] bool is_surprising(const AlignedView& aligned, const Rigid3& world_from_camera) const;

  CorrectCameraOptions options_;
  AlignViewOptions align_;
  std::deque<View> views_;
};

}  // namespace resight
