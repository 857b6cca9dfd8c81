// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "resight/hypotheses/hypothesis.hpp"
#include "resight/models/object_model.hpp"
#include "resight/sensor/prepared_view.hpp"
#include "resight/shape_search/match_criteria.hpp"
#include "resight/shape_search/pose_scorer.hpp"
#include "resight/shape_search/scene_samples.hpp"

namespace resight {

/// Values chosen on the validation seed of the benchmark (bench_shape_search).
struct ShapeSearchOptions {
  bool enabled = false;
  SampleSceneOptions scene{};
  int max_model_samples = 300;      ///< Of the surface of each object.
  int max_seeds = 1000;             ///< Scene points that dipoles start from.
  int pairs_per_seed = 20;          ///< Dipoles from each.
  int max_entries = 32;             ///< Of each object tried per dipole, drawn at random if its bin holds more; of what
                                    ///< is turned a quarter.
  CountSamplesOptions coarse{};     ///< First test of a pose.
  double min_coarse_score = 0.2;    ///< Of 1: all samples confirmed.
  int max_matches = 300;            ///< Of each object, the best, of which two fix a pose; 0: none.
  double match_distance_m = 0.015;  ///< Matches nearer than this agree with a pose.
  int max_refined = 120;            ///< Poses per object that are refined and judged, the best by the first test.
  int refine_iterations = 6;        ///< Of projective ICP.
  double refine_distance_m = 0.02;  ///< Pairs of it that are farther apart do not count.
  double tolerance_m = 0.005;       ///< Of the depth when a refined pose is judged, beside three sigmas of the sensor.
  double min_explained_share = 0.6;  ///< Of the samples that are not hidden.
  double min_visible_share = 0.2;    ///< Of the samples that face the camera: neither hidden nor outside.
  int max_turns = 8;                 ///< Of them so many are judged: those with most samples of the right hue.
  int max_hypotheses = 3;            ///< Per object.
  double min_feature_share = 0.4;    ///< Hypotheses from features that explain less of themselves in their own view
                                     ///< are chance; 0 keeps all.
  double same_place_m = 0.015;       ///< Poses nearer than this (at the object's centre)...
  double same_rotation_rad = 0.21;   ///< ...and this (over its symmetries) are one.
  std::uint64_t seed = 1;
  int num_threads = 1;  ///< Same bits for any value >= 1.
  void check() const;
};

/// A view made ready for the search. It must outlive what is asked of it, and the PreparedView must outlive it.
struct SearchView {
  /// Where `explained` (as large as the view; empty: nowhere) is not 0 nothing is searched, but poses are tried there.
  SearchView(const PreparedView& view, const ShapeSearchOptions& options, const Image<std::uint8_t>& explained = {});
  SceneSamples samples;
  PoseScorer probe;
  double searched_share = 1;  ///< Of the samples: those not explained, and so many of the seeds.
};

/// A pose found by shape.
struct ShapeCandidate {
  int object = -1;  ///< Index into the library.
  Rigid3 camera_from_object;
  double quality = 0;  ///< In [0, 1]: explained share, less for what is hidden or of another pattern.
  int num_explained = 0;
  std::vector<int> matches;  ///< Those of the object that agree with the pose.
};

/// Finds objects by their shape, and checks them by their colours: for what has no print, and hence few matches.
///
/// Pairs of oriented points of the scene (dipoles; Winkelbach et al. 2006, Papazov and Burschka 2010) are looked up
/// among those of all objects. Each that is alike gives a pose, which has to agree with the depth image and with the
/// hue of a few samples; the best are refined by projective ICP and judged as the verification does. Unlike voting over
/// such pairs, nothing is counted: one good pair is enough. Faces of one plane alone are no shape: they fix no pose.
class ShapeSearch {
 public:
  /// The library must outlive it. Objects without normals are not searched.
  ShapeSearch(const ModelLibrary& library, const ShapeSearchOptions& options, const MatchCriteria& criteria = {});
  ~ShapeSearch();
  ShapeSearch(ShapeSearch&&) noexcept;
  ShapeSearch& operator=(ShapeSearch&&) noexcept;

  /// By object, then by quality. Nothing for a view without normals. `matches` (of each object, camera frame; may be
  /// empty): poses that two of them fix are tried as well. The white balance of the view is taken from what is known of
  /// it, `from_features` (world frame): those with many correspondences are seldom wrong.
  [[nodiscard]] std::vector<ShapeCandidate> search(const SearchView& view,
                                                   std::span<const std::vector<Correspondence>> matches = {},
                                                   std::span<const Hypothesis> from_features = {}) const;

  /// How well each hypothesis (world frame) fits a view, once refined in it: a quick look before the verification.
  [[nodiscard]] std::vector<PoseFit> look_at(const SearchView& view, std::span<const Hypothesis> hypotheses) const;

  /// What the search would make of a pose: its first test, and the judgement once refined.
  struct Trial {
    SampleCounts coarse;
    PoseFit fit;
  };
  [[nodiscard]] Trial score_pose(const SearchView& view, int object, const Rigid3& camera_from_object) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace resight
