// SPDX-License-Identifier: Apache-2.0
#include "resight/shape_search/shape_search.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <optional>

#include "resight/core/check.hpp"
#include "resight/core/parallel.hpp"
#include "resight/core/random.hpp"
#include "resight/geometry/symmetry.hpp"
#include "resight/hypotheses/white_balance_weights.hpp"
#include "resight/models/pose_distance.hpp"
#include "resight/models/shape_symmetry_motions.hpp"
#include "resight/segmentation/surface_continuation.hpp"
#include "resight/shape_search/match_pairs.hpp"
#include "resight/shape_search/point_pair_search.hpp"

namespace resight {
namespace {

constexpr double kMinLengthShare = 0.25;    // Of an object's diameter: shorter pairs leave the rotation too uncertain.
constexpr double kMaxLengthShare = 0.8;     // Longer pairs are seldom seen whole.
constexpr double kMaxLength_m = 1;          // Whatever a library says of its objects: the table grows with it.
constexpr int kMaxModelSamples = 300;       // Per object, on its surface.
constexpr int kRefineIterations = 6;        // Of projective ICP.
constexpr double kRefineDistance_m = 0.02;  // Largest distance of its pairs.
constexpr double kMatchDistance_m = 0.015;  // Matches agree with a pose within this, as in V4R.
constexpr int kMaxRotations = 8;            // Of those of a round shape, with most samples of the right chromaticity.
constexpr double kSamePose_m = 0.015;       // Poses nearer than this (at the object's centre),
constexpr double kSameRotation_rad = 0.21;  // and this (12 deg, over its symmetries), are one.
constexpr double kMinExplainedShareOfSamples = 0.1;  // Less of the surface fits too many places.
constexpr double kMarginSigmas = 3;                  // DepthMargin::noise_sigmas of the fine test.
constexpr double kSamePlace_m = 0.03;                // Within this, poses of one object differ only in rotation.
constexpr int kPlacesPerHypothesis = 3;              // Of one object, as a multiple of max_hypotheses.
constexpr int kMaxPerPlace = 2;                      // Poses per place that are left to verification.
constexpr int kMaxRoundPerPlace = 1;                 // Verification finds the rotation of round objects by itself.

constexpr int kAlikeEntries = 4;  // Of round objects, this many entries differ by a rotation only: fewer are tried.

SampleSceneOptions scene_options(const ShapeSearchOptions& options) {
  SampleSceneOptions scene = options.scene;
  scene.seed = options.seed;
  scene.num_threads = options.num_threads;
  return scene;
}

PointCloud without_explained(const PointCloud& points, const Camera& camera, const Image<std::uint8_t>& explained) {
  PointCloud searched;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::optional<Pixel> pixel = camera.pixel_of(points.points[i].cast<double>());
    if (pixel && explained(pixel->u, pixel->v) != 0) continue;
    searched.points.push_back(points.points[i]);
    if (points.has_normals()) searched.normals.push_back(points.normals[i]);
    if (points.has_colors()) searched.colors.push_back(points.colors[i]);
  }
  return searched;
}

}  // namespace

struct ShapeSearch::Impl {
  Impl(const ModelLibrary& models, const ShapeSearchOptions& settings, const MatchCriteria& match_criteria)
      : library(models), options((settings.check(), settings)), criteria(match_criteria) {
    objects.resize(library.objects.size());
    symmetry_motions.resize(library.objects.size());
    if (criteria.symmetry_step_rad)
      for (std::size_t o = 0; o < objects.size(); ++o)
        symmetry_motions[o] = shape_symmetry_motions(library.objects[o], *criteria.symmetry_step_rad);
    parallel_for(objects.size(), options.num_threads,
                 [&](std::size_t o) { objects[o] = make_sampled_model(library.objects[o], kMaxModelSamples); });
    if (!criteria.appearance.use_color)
      for (SampledModel& object : objects) {
        object.colors.clear();
        object.linear_light.clear();
        object.chroma.clear();
      }
    std::ranges::transform(objects, std::back_inserter(grey_objects), [](const SampledModel& o) { return to_grey(o); });
    std::vector<PointPairTable::Samples> samples;
    for (std::size_t o = 0; o < objects.size(); ++o) {
      const auto diameter_m = static_cast<double>(library.objects[o].diameter_m);
      samples.push_back({objects[o].points, objects[o].normals, kMinLengthShare * diameter_m,
                         std::min(kMaxLengthShare * diameter_m, kMaxLength_m)});
    }
    table = PointPairTable(samples);
  }

  // As the colours of the view show them.
  [[nodiscard]] const std::vector<SampledModel>& objects_in(const PoseScorer& scorer) const {
    return scorer.view().is_grey ? grey_objects : objects;
  }

  // As in verification (find_white_balance()): the colours of rough poses are compared before their own photometric
  // fit is known.
  [[nodiscard]] std::vector<SampledModel> balance(const PoseScorer& scorer,
                                                  std::span<const Hypothesis> from_features) const {
    const Rigid3 camera_from_world = scorer.view().frame.world_from_camera.inverse();
    const std::vector<float> votes = white_balance_weights(from_features, objects.size());
    std::vector<PhotometricFit> lights(from_features.size());
    for (std::size_t h = 0; h < lights.size(); ++h)
      if (votes[h] > 0)
        lights[h] = scorer.fit_photometry(objects_in(scorer)[static_cast<std::size_t>(from_features[h].object)],
                                          camera_from_world * from_features[h].world_from_object,
                                          {.base_m = kRefineDistance_m, .noise_sigmas = kMarginSigmas},
                                          criteria.appearance.light);
    const Eigen::Array3f white_balance = find_white_balance(lights, votes);
    std::vector<SampledModel> balanced = objects_in(scorer);
    for (SampledModel& model : balanced) set_white_balance(model, white_balance);
    return balanced;
  }

  [[nodiscard]] std::vector<ShapeCandidate> search(const SearchView& view,
                                                   std::span<const std::vector<Correspondence>> matches,
                                                   std::span<const Hypothesis> from_features) const {
    require(matches.empty() || matches.size() == objects.size(), "ShapeSearch::search: matches of other objects");
    const PoseScorer& scorer = view.scorer;
    if (!view.samples.points.has_normals()) return {};
    const std::vector<SampledModel> balanced = balance(scorer, from_features);
    std::vector<std::vector<PoseCandidate>> of_object = find_candidates(view, without_colors_of_round_shapes(balanced));
    std::vector<std::vector<ShapeCandidate>> scored(objects.size());
    parallel_for(objects.size(), options.num_threads, [&](std::size_t o) {
      if (!matches.empty()) {
        const auto more = poses_of_match_pairs(matches[o], static_cast<int>(o), balanced[o], scorer, options);
        of_object[o].insert(of_object[o].end(), more.begin(), more.end());
      }
      std::stable_sort(of_object[o].begin(), of_object[o].end(),
                       [](const PoseCandidate& a, const PoseCandidate& b) { return a.score > b.score; });
      scored[o] = choose(score_fine(of_object[o], balanced[o], scorer));
      if (matches.empty()) return;
      for (ShapeCandidate& c : scored[o])
        c.matches = agreeing_matches(matches[o], c.camera_from_object, kMatchDistance_m);
    });
    std::vector<ShapeCandidate> result;
    for (const auto& list : scored) result.insert(result.end(), list.begin(), list.end());
    return result;
  }

  [[nodiscard]] std::vector<std::vector<PoseCandidate>> find_candidates(
      const SearchView& view, const std::vector<SampledModel>& balanced) const {
    const PointCloud& scene = view.samples.points;
    std::vector<std::vector<PoseCandidate>> of_object(objects.size());
    if (table.size() == 0) return of_object;
    std::vector<int> max_entries;
    for (std::size_t o = 0; o < objects.size(); ++o)
      max_entries.push_back(is_round_in_shape(o) ? std::max(1, options.max_entries / kAlikeEntries)
                                                 : options.max_entries);
    const PointPairSearch pairs(scene, view.scorer, balanced, table, max_entries, options);
    std::vector<int> seeds(scene.size());
    std::iota(seeds.begin(), seeds.end(), 0);
    Rng(options.seed).shuffle(seeds);
    const auto max_seeds = static_cast<std::size_t>(std::ceil(view.searched_share * options.max_seeds));
    seeds.resize(std::min(seeds.size(), max_seeds));
    std::sort(seeds.begin(), seeds.end());  // Neighbours read the same pixels, which are then in the cache.
    std::vector<std::vector<PoseCandidate>> found(seeds.size());
    parallel_for(seeds.size(), options.num_threads,
                 [&](std::size_t s) { found[s] = pairs.from_seed(static_cast<std::size_t>(seeds[s])); });
    for (const auto& list : found)
      for (const PoseCandidate& c : list) of_object[static_cast<std::size_t>(c.object)].push_back(c);
    return of_object;
  }

  // A few symmetry motions are found one by one. Of many, a pair of points hardly ever gives the right one.
  [[nodiscard]] bool is_round_in_shape(std::size_t object) const {
    constexpr std::size_t kMany = 12;  // As MatchCriteria::symmetry_step_rad says.
    return symmetry_motions[object].size() > kMany;
  }

  [[nodiscard]] std::vector<SampledModel> without_colors_of_round_shapes(std::vector<SampledModel> models) const {
    for (std::size_t o = 0; o < models.size(); ++o)
      if (is_round_in_shape(o)) models[o].chroma.clear();
    return models;
  }

  // The pose, or its rotations with most samples of the right chromaticity.
  [[nodiscard]] std::vector<Rigid3> rotations_of(std::size_t object, const Rigid3& pose, const SampledModel& balanced,
                                                 const PoseScorer& scorer) const {
    if (!is_round_in_shape(object)) return {pose};
    CountSamplesOptions all{};
    all.max_samples = all.max_wrong = static_cast<int>(balanced.points.size());
    std::vector<std::pair<float, Rigid3>> scored;
    for (const Rigid3& motion : symmetry_motions[object])
      scored.emplace_back(scorer.score_coarse(balanced, Rigid3f(pose * motion), all).score(), pose * motion);
    std::stable_sort(scored.begin(), scored.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
    std::vector<Rigid3> best;
    for (std::size_t t = 0; t < std::min(scored.size(), static_cast<std::size_t>(kMaxRotations)); ++t)
      best.push_back(scored[t].second);
    return best;
  }

  // The best by the coarse test, no two alike, refined; those that pass the fine test.
  [[nodiscard]] std::vector<ShapeCandidate> score_fine(const std::vector<PoseCandidate>& candidates,
                                                       const SampledModel& balanced, const PoseScorer& scorer) const {
    std::vector<ShapeCandidate> scored;
    std::vector<Rigid3> tried;
    for (const PoseCandidate& c : candidates) {
      if (static_cast<int>(tried.size()) == options.max_refined) break;
      const Rigid3 rough{c.camera_from_object.rotation.cast<double>(), c.camera_from_object.translation.cast<double>()};
      const auto object = static_cast<std::size_t>(c.object);
      const ObjectModel& sought = library.objects[object];
      const ObjectSymmetries& symmetries = is_round_in_shape(object) ? sought.shape_symmetries : sought.symmetries;
      if (std::any_of(tried.begin(), tried.end(), [&](const Rigid3& other) {
            return is_same_place(sought, symmetries, rough, other, same_place());
          }))
        continue;
      const Rigid3 start{nearest_rotation(rough.rotation), rough.translation};
      tried.push_back(start);
      const SampledModel& model = objects_in(scorer)[object];
      const Rigid3 refined = scorer.refine(model, start, kRefineIterations, kRefineDistance_m);
      const PoseFit least = least_fit(model);
      if (is_round_in_shape(object) && !scorer.fits_in_shape(model, refined, margin(), least)) continue;
      for (const Rigid3& pose : rotations_of(object, refined, balanced, scorer)) {
        const PoseFit fit = scorer.score_fine(model, pose, margin(), criteria, least);
        if (!fit.reaches(least)) continue;
        const double doubt = std::sqrt(fit.visible_share * std::max(0.0, fit.pattern_similarity));
        scored.push_back({c.object, pose, fit.explained_share * doubt, fit.num_explained, {}});
      }
    }
    return scored;
  }

  [[nodiscard]] PoseFit least_fit(const SampledModel& model) const {
    const double num_explained = kMinExplainedShareOfSamples * static_cast<double>(model.points.size());
    return {options.min_explained_share, options.min_visible_share, criteria.min_pattern_similarity,
            static_cast<int>(std::ceil(num_explained))};
  }

  // First the best pose of each place: an object may be there more than once. Then further poses of the same places.
  [[nodiscard]] std::vector<ShapeCandidate> choose(std::vector<ShapeCandidate> scored) const {
    const auto is_better = [](const ShapeCandidate& a, const ShapeCandidate& b) { return a.quality > b.quality; };
    std::stable_sort(scored.begin(), scored.end(), is_better);
    const int max_places = kPlacesPerHypothesis * options.max_hypotheses;
    std::vector<ShapeCandidate> kept;
    std::vector<ShapeCandidate> further;
    for (ShapeCandidate& c : scored) {
      if (is_repeated(c, kept) || is_repeated(c, further)) continue;
      const int num_here = count_at_place(c, kept) + count_at_place(c, further);
      const int most = is_round_in_shape(static_cast<std::size_t>(c.object)) ? kMaxRoundPerPlace : kMaxPerPlace;
      if (num_here > 0) {
        if (num_here < most) further.push_back(std::move(c));
      } else if (static_cast<int>(kept.size()) < max_places) {
        kept.push_back(std::move(c));
      }
    }
    for (ShapeCandidate& c : further)
      if (static_cast<int>(kept.size()) < options.max_hypotheses) kept.push_back(std::move(c));
    std::stable_sort(kept.begin(), kept.end(), is_better);
    return kept;
  }

  [[nodiscard]] bool is_repeated(const ShapeCandidate& c, std::span<const ShapeCandidate> others) const {
    const ObjectModel& model = library.objects[static_cast<std::size_t>(c.object)];
    return std::ranges::any_of(others, [&](const ShapeCandidate& other) {
      return is_same_place(model, c.camera_from_object, other.camera_from_object, same_place());
    });
  }

  [[nodiscard]] int count_at_place(const ShapeCandidate& c, std::span<const ShapeCandidate> others) const {
    const ObjectModel& model = library.objects[static_cast<std::size_t>(c.object)];
    return static_cast<int>(std::ranges::count_if(others, [&](const ShapeCandidate& other) {
      return center_distance_m(model, c.camera_from_object, other.camera_from_object) < kSamePlace_m;
    }));
  }

  [[nodiscard]] DepthMargin margin() const { return {.base_m = options.tolerance_m, .noise_sigmas = kMarginSigmas}; }

  [[nodiscard]] SamePlaceOptions same_place() const { return {kSamePose_m, kSameRotation_rad}; }

  const ModelLibrary& library;
  ShapeSearchOptions options;
  MatchCriteria criteria;
  std::vector<SampledModel> objects;
  std::vector<SampledModel> grey_objects;             // to_grey() of each.
  std::vector<std::vector<Rigid3>> symmetry_motions;  // shape_symmetry_motions() of each.
  PointPairTable table;
};

SearchView::SearchView(const PreparedView& view, const ShapeSearchOptions& options, float largest_diameter_m,
                       const Image<std::uint8_t>& explained)
    : samples(sample_scene(view, scene_options(options),
                           std::max<double>(kMaxPlane_m, kMaxFaceShare * largest_diameter_m))),
      scorer(view, samples.planes, options.num_threads) {
  if (explained.size() == 0 || samples.points.empty()) return;
  PointCloud searched = without_explained(samples.points, view.frame.camera, explained);
  searched_share = static_cast<double>(searched.size()) / static_cast<double>(samples.points.size());
  samples.points = std::move(searched);
}

ShapeSearch::ShapeSearch(const ModelLibrary& library, const ShapeSearchOptions& options, const MatchCriteria& criteria)
    : impl_(std::make_unique<Impl>(library, options, criteria)) {}
ShapeSearch::~ShapeSearch() = default;
ShapeSearch::ShapeSearch(ShapeSearch&&) noexcept = default;
ShapeSearch& ShapeSearch::operator=(ShapeSearch&&) noexcept = default;

std::vector<ShapeCandidate> ShapeSearch::search(const SearchView& view,
                                                std::span<const std::vector<Correspondence>> matches,
                                                std::span<const Hypothesis> from_features) const {
  return impl_->search(view, matches, from_features);
}

std::vector<PoseFit> ShapeSearch::score_hypotheses(const SearchView& view,
                                                   std::span<const Hypothesis> hypotheses) const {
  const ShapeSearchOptions& options = impl_->options;
  const Rigid3 camera_from_world = view.scorer.view().frame.world_from_camera.inverse();
  std::vector<PoseFit> fits(hypotheses.size(),
                            PoseFit{.explained_share = 1});  // Models without normals are not scored.
  parallel_for(hypotheses.size(), options.num_threads, [&](std::size_t h) {
    const SampledModel& model = impl_->objects_in(view.scorer).at(static_cast<std::size_t>(hypotheses[h].object));
    if (model.points.empty()) return;
    const Rigid3 pose = view.scorer.refine(model, camera_from_world * hypotheses[h].world_from_object,
                                           kRefineIterations, kRefineDistance_m);
    fits[h] = view.scorer.score_fine(model, pose, impl_->margin(), impl_->criteria);
  });
  return fits;
}

ShapeSearch::Trial ShapeSearch::score_pose(const SearchView& view, int object, const Rigid3& camera_from_object) const {
  const SampledModel& model = impl_->objects_in(view.scorer).at(static_cast<std::size_t>(object));
  const Rigid3 refined = view.scorer.refine(model, camera_from_object, kRefineIterations, kRefineDistance_m);
  return {view.scorer.score_coarse(model, Rigid3f(camera_from_object), {}),
          view.scorer.score_fine(model, refined, impl_->margin(), impl_->criteria)};
}

}  // namespace resight
