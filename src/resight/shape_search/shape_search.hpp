// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "resight/core/options.hpp"
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
  bool skip_planes = false;
  SampleSceneOptions scene{};
  int max_seeds = 1000;
  int max_entries = 32;
  int max_matches = 300;
  int max_refined = 120;
  double tolerance_m = 0.005;
  double min_explained_share = 0.6;
  double min_visible_share = 0.2;
  int max_hypotheses = 3;
  double min_feature_share = 0.4;
  std::uint64_t seed = 1;
  int num_threads = 1;  ///< Same bits for any value >= 1.
  void check() const { check_options("ShapeSearchOptions", *this); }
};

inline void declare(OptionVisitor& v, ShapeSearchOptions& o) {
  v.field("enabled", o.enabled, "Objects are searched by shape as well as by features: for untextured ones.", "ours");
  v.only_if(o.enabled, "enabled", "true", [&] {
    v.field("skip_planes", o.skip_planes,
            "No SHOT keypoints on planes larger than the largest object: they have no shape of their own.");
    v.group("scene", o.scene);
    v.field("max_seeds", o.max_seeds, at_least(1), "Scene points that oriented point pairs start from. More: slower.",
            "Winkelbach et al. 2006");
    v.field("max_entries", o.max_entries, at_least(1),
            "Model pairs tried per object and scene pair, drawn at random if there are more (a quarter of them for "
            "objects round in shape).");
    v.field("max_matches", o.max_matches, at_least(0),
            "Number of the best matches per object whose pairs also give poses. 0: none do.");
    v.field("max_refined", o.max_refined, at_least(0), "Poses per object that are refined and scored, the best first.");
    v.field("tolerance_m", o.tolerance_m, positive(),
            "Tolerance of the depth when a refined pose is scored, plus three standard deviations of the sensor.");
    v.field("min_explained_share", o.min_explained_share, between(0, 1),
            "Least explained share of the samples that are not occluded.");
    v.field("min_visible_share", o.min_visible_share, between(0, 1),
            "Least share of the samples facing the camera that must be in the image and not occluded.");
    v.field(
        "max_hypotheses", o.max_hypotheses, at_least(0),
        "Hypotheses per object and view. An object seen at more places has one per place, up to three times as many.");
    v.field(
        "min_feature_share", o.min_feature_share, between(0, 1),
        "Hypotheses from features that explain a smaller share of themselves in their own view are spurious and are "
        "dropped. 0: none is.");
  });
  v.seed(o.seed);
  v.num_threads(o.num_threads);
}

/// A view prepared for the search. The PreparedView must outlive it.
struct SearchView {
  /// Pixels where `explained` is not 0 start no search (size of the view; empty: none), but poses are scored there.
  /// `largest_diameter_m`: of the objects sought.
  SearchView(const PreparedView& view, const ShapeSearchOptions& options, float largest_diameter_m,
             const Image<std::uint8_t>& explained = {});
  SceneSamples samples;
  PoseScorer scorer;
  double searched_share = 1;  ///< Share of the samples that are searched; scales the number of seeds.
};

/// A pose found by shape.
struct ShapeCandidate {
  int object = -1;  ///< Index into the library.
  Rigid3 camera_from_object;
  double quality = 0;  ///< In [0, 1]: explained share, reduced by occlusion and by a different texture.
  int num_explained = 0;
  std::vector<int> matches;  ///< Those of the object that agree with the pose.
};

/// Finds objects by shape and checks them by colour: for untextured objects, which have few matches.
///
/// Oriented point pairs of the scene (Winkelbach et al. 2006, Papazov and Burschka 2010) are looked up among those of
/// all objects. Each similar pair gives a pose, which must agree with the depth image and with the chromaticity of a
/// few samples. The best are refined by projective ICP and scored like in verification. There is no voting: one good
/// pair is enough. Pairs on one plane fix no pose.
class ShapeSearch {
 public:
  /// The library must outlive it. Objects without normals are not searched.
  ShapeSearch(const ModelLibrary& library, const ShapeSearchOptions& options, const MatchCriteria& criteria = {});
  ~ShapeSearch();
  ShapeSearch(ShapeSearch&&) noexcept;
  ShapeSearch& operator=(ShapeSearch&&) noexcept;

  /// Sorted by object, then quality. Empty for a view without normals. `matches` (per object, camera frame; may be
  /// empty): pairs of them also give poses. `from_features` (world frame) determine the white balance.
  [[nodiscard]] std::vector<ShapeCandidate> search(const SearchView& view,
                                                   std::span<const std::vector<Correspondence>> matches = {},
                                                   std::span<const Hypothesis> from_features = {}) const;

  /// Refines each hypothesis (world frame) in this view and scores it.
  [[nodiscard]] std::vector<PoseFit> score_hypotheses(const SearchView& view,
                                                      std::span<const Hypothesis> hypotheses) const;

  /// Coarse score of a pose, and fine score after refinement.
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
