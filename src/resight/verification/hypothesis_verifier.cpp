// SPDX-License-Identifier: Apache-2.0
#include "resight/verification/hypothesis_verifier.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "resight/core/check.hpp"
#include "resight/core/parallel.hpp"
#include "resight/hypotheses/white_balance_weights.hpp"
#include "resight/models/pose_distance.hpp"
#include "resight/verification/acceptance.hpp"
#include "resight/verification/cues.hpp"
#include "resight/verification/selection_search.hpp"

namespace resight {
namespace {

// Refined hypotheses of one object nearer than this (at its centre; over its symmetries, 10 deg) are one.
constexpr double kMergeDistance_m = 0.01;
constexpr double kMergeRotation_rad = 0.174533;
// A small object, too, stands on something that should be recognised as a plane.
constexpr float kMinSurroundings_m = 0.25F;

void check_input(std::span<const Hypothesis> hypotheses, const ModelLibrary& library,
                 std::span<const VerificationView> views, std::span<const std::uint8_t> present) {
  for (std::size_t i = 0; i < hypotheses.size(); ++i) {
    const int object = hypotheses[i].object;
    require(object >= 0 && static_cast<std::size_t>(object) < library.objects.size(),
            "verify_hypotheses: hypothesis " + std::to_string(i) + " has object = " + std::to_string(object) +
                " (must be an index of the library)");
    require(hypotheses[i].world_from_object.is_rigid(),
            "verify_hypotheses: the pose of hypothesis " + std::to_string(i) + " is not rigid");
  }
  for (const VerificationView& view : views) {
    require(view.view != nullptr, "verify_hypotheses: a view is null");
    const Camera& camera = view.view->frame.camera;
    require(camera.is_valid() && view.view->cloud.width() == camera.width && view.view->cloud.height() == camera.height,
            "verify_hypotheses: a view's cloud does not have the size of its camera's image");
    require(view.view->surface_color().size() == view.view->cloud.z.size(),
            "verify_hypotheses: a view's colours do not have the size of its cloud");
  }
  require(present.empty() || present.size() == views.size() * hypotheses.size(),
          "verify_hypotheses: present has " + std::to_string(present.size()) +
              " entries (must be views x hypotheses, or none)");
}

// Where hypotheses need the scene: as far around each as it is large, so that the planes found there are larger than
// the object.
std::vector<Ball> surroundings(std::span<const Hypothesis> hypotheses, const std::vector<PreparedModel>& models,
                               const VerifyOptions& options) {
  std::vector<Ball> balls;
  for (const Hypothesis& h : hypotheses) {
    const PreparedModel& model = models[h.object];
    const float reach = std::max(1.5F * model.diameter_m, kMinSurroundings_m) +
                        static_cast<float>(options.support.max_distance_m + options.clutter.radius_m);
    balls.push_back({Rigid3f(h.world_from_object) * model.center, reach});
  }
  return balls;
}

std::vector<std::uint8_t> allowed_views(std::span<const std::uint8_t> present, std::size_t num_views,
                                        std::size_t num_hypotheses, std::size_t h) {
  std::vector<std::uint8_t> allowed(num_views, 1);
  if (!present.empty())
    for (std::size_t v = 0; v < num_views; ++v) allowed[v] = present[v * num_hypotheses + h];
  return allowed;
}

// First the white balance of the scene from all hypotheses, then the cues of each under it.
std::vector<HypothesisCues> compute_all_cues(std::span<const Hypothesis> hypotheses,
                                             const std::vector<PreparedModel>& models, const PreparedScene& scene,
                                             std::span<const DepthView> views, std::span<const std::uint8_t> present,
                                             const VerifyOptions& options) {
  std::vector<std::optional<CueComputer>> computers(hypotheses.size());
  parallel_for(hypotheses.size(), options.num_threads, [&](std::size_t h) {
    const std::vector<std::uint8_t> allowed = allowed_views(present, views.size(), hypotheses.size(), h);
    computers[h].emplace(models[hypotheses[h].object], hypotheses[h].world_from_object, hypotheses[h].correspondences,
                         scene, views, allowed, options);
  });
  std::vector<PhotometricFit> lights;
  for (const std::optional<CueComputer>& computer : computers) lights.push_back(computer->light());
  const Eigen::Array3f white_balance = find_white_balance(lights, white_balance_weights(hypotheses, models.size()));
  std::vector<HypothesisCues> cues(hypotheses.size());
  parallel_for(hypotheses.size(), options.num_threads,
               [&](std::size_t h) { cues[h] = computers[h]->finish(white_balance); });
  return cues;
}

std::vector<int> visible_points(const HypothesisCues& cues) {
  std::vector<int> visible;
  for (std::size_t i = 0; i < cues.state.size(); ++i)
    if (cues.state[i] != ModelPointState::kNotVisible) visible.push_back(static_cast<int>(i));
  return visible;
}

// Hypotheses of one object that refinement and symmetry motions have brought together are one: that with most
// correspondences stays. Which of them explains a few points more is random.
void merge_duplicates(std::span<const Hypothesis> hypotheses, const ModelLibrary& library, const VerifyOptions& options,
                      std::vector<int>& candidates, std::vector<HypothesisEvidence>& evidence) {
  if (!options.refine.max_iterations && !options.refine.symmetry_step_rad) return;
  std::vector<int> by_support = candidates;
  std::stable_sort(by_support.begin(), by_support.end(), [&](int a, int b) {
    return hypotheses[a].correspondences.size() > hypotheses[b].correspondences.size();
  });
  std::vector<int> kept;
  for (const int h : by_support) {
    const ObjectModel& model = library.objects[hypotheses[h].object];
    const auto same = std::find_if(kept.begin(), kept.end(), [&](int other) {
      const Rigid3& reference = evidence[other].world_from_object;
      if (hypotheses[other].object != hypotheses[h].object) return false;
      const PoseDifference difference = compare_poses(evidence[h].world_from_object, reference, model);
      return difference.center_distance_m < kMergeDistance_m && difference.rotation_rad < kMergeRotation_rad;
    });
    if (same == kept.end()) {
      kept.push_back(h);
    } else {
      evidence[h].verdict = Verdict::kSuppressed;
      evidence[h].suppressed_by = *same;
      evidence[h].costs.unary = unary_cost(evidence[h]);
    }
  }
  std::sort(kept.begin(), kept.end());
  candidates = std::move(kept);
}

// The active candidate that keeps `rejected` out: without it, switching `rejected` on would be cheapest.
// Those of other components have no say.
int find_competitor(Selection& selection, const std::vector<int>& component, int rejected) {
  int competitor = -1;
  FixedCost best_change = selection.change_if_switched(rejected);
  for (const int c : component) {
    if (!selection.is_active(c)) continue;
    selection.switch_candidate(c);
    const FixedCost change = selection.change_if_switched(rejected);
    selection.switch_candidate(c);
    if (change >= best_change) continue;
    best_change = change;
    competitor = c;
  }
  return competitor;
}

void explain_choice(const SelectionProblem& problem, const SearchSelectionResult& found,
                    const std::vector<int>& candidates, std::vector<HypothesisEvidence>& evidence) {
  Selection none(problem);
  Selection chosen(problem);
  for (std::size_t c = 0; c < candidates.size(); ++c)
    if (found.active[c] != 0) chosen.switch_candidate(static_cast<int>(c));
  for (const std::vector<int>& component : find_components(problem)) {
    for (const int c : component) {
      HypothesisEvidence& e = evidence[candidates[c]];
      const FixedCost change = none.change_if_switched(c);
      e.costs.unary = from_fixed(change);
      e.accepted = found.active[c] != 0;
      e.verdict = e.accepted ? Verdict::kAccepted : Verdict::kCost;
      if (e.accepted || change >= 0) continue;
      const int competitor = find_competitor(chosen, component, c);
      if (competitor < 0) continue;
      e.verdict = Verdict::kSuppressed;
      e.suppressed_by = candidates[competitor];
    }
  }
}

void choose(std::span<const Hypothesis> hypotheses, const ModelLibrary& library,
            const std::vector<HypothesisCues>& cues, const std::vector<int>& candidates, const VerifyOptions& options,
            VerifyResult& result) {
  std::vector<const HypothesisCues*> candidate_cues;
  std::vector<PlacedModel> placed;
  for (const int h : candidates) {
    candidate_cues.push_back(&cues[h]);
    placed.push_back({&library.objects[hypotheses[h].object].surface, result.evidence[h].world_from_object});
  }
  const std::vector<SharedVoxels> shared = count_shared_voxels(placed, options.resolution_m, options.num_threads);
  const SelectionProblem problem = make_selection_problem(candidate_cues, shared, options.selection);
  const SearchSelectionResult found = search_selection(problem, options.selection, options.seed);
  explain_choice(problem, found, candidates, result.evidence);
  result.cost = from_fixed(found.cost);
}

}  // namespace

HypothesisVerifier::HypothesisVerifier(const ModelLibrary& library, const VerifyOptions& options)
    : library_(library), options_(options) {
  options_.check();
}

// Those that the hypotheses need and that are not made yet; others stay empty.
void HypothesisVerifier::prepare_models(std::span<const Hypothesis> hypotheses, bool as_grey) {
  if (std::exchange(models_are_grey_, as_grey) != as_grey) models_.clear();
  models_.resize(library_.objects.size());
  std::vector<std::uint8_t> needed(models_.size(), 0);
  for (const Hypothesis& h : hypotheses) needed[h.object] = models_[h.object].points.empty() ? 1 : 0;
  parallel_for(models_.size(), options_.num_threads, [&](std::size_t i) {
    if (needed[i] != 0) models_[i] = prepare_model(library_.objects[i], options_, as_grey);
  });
}

VerifyResult HypothesisVerifier::verify(std::span<const Hypothesis> hypotheses, const PointCloud& scene_in_world,
                                        std::span<const VerificationView> views,
                                        std::span<const std::uint8_t> present) {
  check_input(hypotheses, library_, views, present);
  VerifyResult result;
  result.evidence.resize(hypotheses.size());
  if (hypotheses.empty()) return result;
  const std::vector<DepthView> depth_views =
      prepare_depth_views(views, options_.visibility.min_edge_distance_px, options_.num_threads);
  prepare_models(hypotheses, std::ranges::all_of(views, [](const VerificationView& v) { return v.view->is_grey; }));
  const PreparedScene scene =
      prepare_scene(crop_to_balls(scene_in_world, surroundings(hypotheses, models_, options_)), options_);
  std::vector<HypothesisCues> cues = compute_all_cues(hypotheses, models_, scene, depth_views, present, options_);
  std::vector<int> candidates;
  for (std::size_t h = 0; h < hypotheses.size(); ++h) {
    result.evidence[h] = std::move(cues[h].evidence);
    if (may_be_selected(result.evidence[h], options_.acceptance)) candidates.push_back(static_cast<int>(h));
    cues[h].evidence = result.evidence[h];
  }
  merge_duplicates(hypotheses, library_, options_, candidates, result.evidence);
  choose(hypotheses, library_, cues, candidates, options_, result);
  for (std::size_t h = 0; h < hypotheses.size(); ++h)
    if (HypothesisEvidence& e = result.evidence[h]; e.accepted)
      e.uncertainty =
          estimate_pose_uncertainty(models_[hypotheses[h].object], e.world_from_object, visible_points(cues[h]),
                                    hypotheses[h].correspondences, scene, options_.refine);
  return result;
}

VerifyResult verify_hypotheses(std::span<const Hypothesis> hypotheses, const ModelLibrary& library,
                               const PointCloud& scene_in_world, std::span<const VerificationView> views,
                               std::span<const std::uint8_t> present, const VerifyOptions& options) {
  return HypothesisVerifier(library, options).verify(hypotheses, scene_in_world, views, present);
}

}  // namespace resight
