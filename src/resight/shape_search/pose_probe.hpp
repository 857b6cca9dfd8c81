// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <vector>

#include "resight/geometry/rigid3.hpp"
#include "resight/sensor/prepared_view.hpp"
#include "resight/verification/lab_color.hpp"
#include "resight/verification/light_fit.hpp"

namespace resight {

/// An object as poses of it are tested: samples of its surface in random order.
struct ProbeModel {
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3f> normals;
  std::vector<Eigen::Vector3f> linear_light;  ///< Empty if its colours are not known.
  std::vector<LabColor> lab;                  ///< Of the same.
  Eigen::Vector3f center = Eigen::Vector3f::Zero();
};

struct ProbeOptions {
  double tolerance_m = 0.012;  ///< Depth that differs less confirms a point, more contradicts or hides it...
  double tolerance_sigmas = 3;  ///< ...beside this many sigmas of the sensor's noise.
  double max_chroma_difference = 0.2;  ///< Of a/128 and b/128.
};

/// What a view says about the samples of an object at a pose.
struct ProbeCounts {
  int facing = 0;     ///< Turned to the camera and inside the image.
  int confirmed = 0;  ///< At the measured depth,
  int off_color = 0;  ///< of these: of another hue.
  int through = 0;    ///< The camera looks through them.
  int hidden = 0;     ///< Behind what was measured.
};

/// A view as poses are tested in it.
class PoseProbe {
 public:
  explicit PoseProbe(const PreparedView& view, double max_depth_m, int num_threads);

  /// Coarse test with the first `max_samples` samples that face the camera. Gives up early, with what it has, when
  /// more than `max_wrong` are seen through or of another hue.
  [[nodiscard]] ProbeCounts count(const ProbeModel& model, const Rigid3f& camera_from_object, int max_samples,
                                  int max_wrong, const ProbeOptions& options) const;

  /// Projective point-to-plane ICP.
  [[nodiscard]] Rigid3 refine(const ProbeModel& model, const Rigid3& camera_from_object, int iterations,
                              double max_distance_m) const;

  /// Share of the samples facing the camera and not hidden that depth, normal and (after a fit of the light) colour
  /// confirm.
  struct Fit {
    double explained_share = 0;
    double visible_share = 0;  ///< Of the facing samples: not hidden.
    double pattern_similarity = 1;
    int num_explained = 0;
  };
  [[nodiscard]] Fit judge(const ProbeModel& model, const Rigid3f& camera_from_object, double tolerance_m,
                          double sigma_l, double sigma_ab, const LightLimits& limits) const;

  [[nodiscard]] int pixel_of(const Eigen::Vector3f& p) const;  // -1 outside
  [[nodiscard]] const LabColor& lab(int pixel) const { return lab_[static_cast<std::size_t>(pixel)]; }

 private:
  const PreparedView& view_;
  Image<LabColor> lab_;
};

}  // namespace resight
