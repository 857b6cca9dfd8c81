// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>

#include "resight/core/options.hpp"
#include "resight/evidence/surface_evidence.hpp"
#include "resight/sensor/prepared_view.hpp"

namespace resight {

struct CompareViewsOptions {
  double sigmas = 3;
  std::optional<double> recolored_sigmas{};
  int window_radius_px = 1;
  int contour_radius_px = 0;
  int num_threads = 1;  ///< Same bits for any value >= 1.
  void check() const { check_options("CompareViewsOptions", *this); }
};

inline void declare(OptionVisitor& v, CompareViewsOptions& o) {
  v.field("sigmas", o.sigmas, positive(),
          "Surfaces differ if they lie farther apart, along the normal, than this many standard deviations of the "
          "noise of both views.",
          "Nguyen et al. 2012 (noise of the sensor)");
  v.field("recolored_sigmas", o.recolored_sigmas, positive(),
          "The same where a colour stands out that did not before. off: colours do not count, and neither do means.",
          "ours");
  v.field("window_radius_px", o.window_radius_px, between(0, 100),
          "A measurement within this many rows and columns may explain a surface, and must not contradict free space.");
  v.field("contour_radius_px", o.contour_radius_px, between(0, 100),
          "A surface that is seen through contradicts nothing if a measurement within this many rows and columns "
          "explains it: contours waver.");
  v.num_threads(o.num_threads);
}

/// What a view says about the surfaces that another view measured, pixel by pixel of that other view.
struct ViewComparison {
  Image<Evidence> evidence;
  Image<int> pixels;  ///< Index of the pixel of the view that the surface projects to; -1: none, or at too grazing an
                      ///< angle.
  /// By how much the view contradicts a surface that it sees through: 0 at the least difference that counts, 1 from
  /// twice that on, and less where the colours are as before (ColorChanges::similar_share). 0 elsewhere, and within
  /// CompareViewsOptions::contour_radius_px of what explains it.
  Image<float> contradiction;
};

/// Compares the surfaces of one view with another view. The test is statistical: the distance between the surface and
/// the measurement, along the normal of the surface, is compared with the noise of both views, which depends on range
/// and angle (NoiseImages::normal_m). `noise_scale` multiplies it; see estimate_noise_scale(). Pixels without depth in
/// either view are kUnobserved, and so is what projects between the measurements of a depth edge.
///
/// Two kinds of surface need less distance where the colours differ (find_color_changes()). Thin things: a surface that
/// stands out in colour is seen through from `recolored_sigmas` on. Flat things: a surface is seen through if the mean
/// distance within a few centimetres (MeanDistances) is more than `sigmas` standard deviations of such means.
///
/// Both poses must be in one world frame.
[[nodiscard]] ViewComparison compare_views(const PreparedView& surfaces, const PreparedView& view, double noise_scale,
                                           const CompareViewsOptions& options = {});

/// How much larger the differences between two views are than the noise of the model: a robust standard deviation (1.48
/// times the median absolute value) of the normalised distances of compare_views(), at least 0.7. Poses that are
/// slightly off and sensors noisier than the model make it larger; changes do not, as long as most of the scene stays.
/// 1 for views that have little in common.
[[nodiscard]] double estimate_noise_scale(const PreparedView& surfaces, const PreparedView& view);

/// By how many pixels the occluding contours of two views disagree: the radius of the smallest window around a contour
/// pixel of `surfaces` in which a measurement of the view agrees with it, for nine in ten of those with one within 8
/// px. Poses that are slightly off, distortion that is left over and depth that smears over an edge make it larger;
/// changes do not, because nothing near them agrees. 0 for views that have few contours in common. `noise_scale` and
/// `sigmas`: as for compare_views().
[[nodiscard]] int estimate_misregistration_px(const PreparedView& surfaces, const PreparedView& view,
                                              double noise_scale, double sigmas);

}  // namespace resight
