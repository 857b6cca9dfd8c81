// SPDX-License-Identifier: Apache-2.0
#include "resight/recognition/scene_recognizer.hpp"

#include <utility>

#include "resight/history/object_history.hpp"
#include "resight/recognition/detections.hpp"
#include "resight/recognition/presence_mask.hpp"
#include "resight/recognition/stage_options.hpp"
#include "resight/recognition/time_budget.hpp"
#include "resight/recognition/view_hypothesis_source.hpp"
#include "resight/verification/hypothesis_verifier.hpp"

namespace resight {

struct SceneRecognizer::Impl {
  using Hypotheses = std::vector<Hypothesis>;
  using Mask = std::vector<std::uint8_t>;  // By view of the window and hypothesis.

  Impl(const ModelLibrary& models, RecognizerConfig settings, std::shared_ptr<ViewHypothesisStore> store, Clock clock)
      : library(models),
        config(checked_and_seeded(std::move(settings))),
        corrector(config.camera.color_offset),
        scene(scene_options(config)),
        planner(make_search_planner(models, config)),
        source(models, config, std::move(store)),
        pool(models, config.hypotheses.cluster, config.hypotheses.generate.grouping.pose),
        budget(config.run.deadline_ms, std::move(clock)),
        verifier(models, config.verify),
        history(models, config.history) {}

  SceneUpdate add_view(RgbdFrame frame, RecognitionTrace* trace);
  void add_to_scene(RgbdFrame frame, SceneUpdate& update);
  [[nodiscard]] Hypotheses search(SceneUpdate& update, RecognitionTrace* trace);
  [[nodiscard]] std::shared_ptr<const ViewHypotheses> generate(const PreparedView& view, int number);
  [[nodiscard]] Hypotheses merge_and_cluster(SceneUpdate& update, RecognitionTrace* trace);
  [[nodiscard]] Hypotheses tracked_hypotheses() const;
  [[nodiscard]] std::vector<std::uint8_t> outdated(const Hypotheses& hypotheses) const;
  [[nodiscard]] Mask find_presence(Hypotheses& hypotheses, SceneUpdate& update) const;
  void verify(VerifiedHypotheses& verified, SceneUpdate& update);
  void update_history(SceneUpdate& update);

  const ModelLibrary& library;
  RecognizerConfig config;
  CameraErrorCorrector corrector;
  DynamicScene scene;
  SearchPlanner planner;
  ViewHypothesisSource source;
  HypothesisPool pool;
  TimeBudget budget;
  HypothesisVerifier verifier;
  ObjectHistory history;
};

SceneUpdate SceneRecognizer::Impl::add_view(RgbdFrame frame, RecognitionTrace* trace) {
  budget.start_view();
  SceneUpdate update;
  add_to_scene(std::move(frame), update);  // Algorithm 1
  // Section III-A: hypotheses of this view, merged with those of the last K views and clustered by Eq. (1).
  pool.add_view(update.searched ? search(update, trace) : Hypotheses{}, scene.view_numbers());
  VerifiedHypotheses verified{merge_and_cluster(update, trace), {}, {}};
  budget.drop_late(
      verified.hypotheses, [&](const Hypothesis& h) { return pool.is_tracked(h); }, update.left_out);
  // Section III-B: changes exclude views in which an object was absent. Section III-A: verification in the others.
  verified.present = find_presence(verified.hypotheses, update);
  verify(verified, update);
  if (!update.changes.pose_suspect) update_history(update);
  // What this view showed decides where the next one is searched, and which hypotheses it takes over.
  if (pool.is_tracked_object_rejected(verified.hypotheses, verified.evidence)) planner.request_search();
  pool.forget_refuted(verified.hypotheses, verified.evidence, config.hypotheses.min_carried_share);
  drop_unlikely(update.detections, config.detections);
  if (trace != nullptr) {
    trace->verified = std::move(verified.hypotheses);
    trace->evidence = std::move(verified.evidence);
  }
  return update;
}

void SceneRecognizer::Impl::add_to_scene(RgbdFrame frame, SceneUpdate& update) {
  update.view = scene.num_views();
  update.view_name = frame.name;
  update.camera_errors = corrector.errors();
  if (corrector.has_changed()) scene.forget_views();
  PreparedView view;
  {
    const ScopedTimer timer(update.times, "prepare");
    view = corrector.prepare(std::move(frame), config.prepare);
  }
  update.changes = scene.add_view(std::move(view), &update.times);
  update.world_from_camera = scene.window().back().raw.world_from_camera;
  update.pose_correction = scene.window().back().pose_correction;
  update.reconstruction_points = scene.reconstruction().size();
  planner.set_outdated(history.tracked_objects(), outdated(tracked_hypotheses()));
  update.searched = planner.needs_search(scene.window().back().cleared, update.changes);
}

// The hypotheses of the current view alone, stored or new.
auto SceneRecognizer::Impl::search(SceneUpdate& update, RecognitionTrace* trace) -> Hypotheses {
  const PreparedView& view = scene.window().back().cleared;
  std::shared_ptr<const ViewHypotheses> found = source.find_stored(update.view);
  if (!found) found = generate(view, update.view);
  source.reserve_ids(*found);
  update.times.add(found->times);
  update.left_out = found->left_out;
  for (const auto& c : found->correspondences) update.counts.correspondences += static_cast<int>(c.size());
  update.counts.generated = static_cast<int>(found->hypotheses.size());
  if (trace != nullptr) {
    trace->sift = found->sift;
    trace->shot = found->shot;
    trace->correspondences = found->correspondences;
  }
  return move_hypotheses(*found, view.frame.world_from_camera);
}

std::shared_ptr<const ViewHypotheses> SceneRecognizer::Impl::generate(const PreparedView& view, int number) {
  StageTimes planning_times;
  Image<std::uint8_t> skipped;
  if (planner.skips_places()) {
    const ScopedTimer timer(planning_times, "attention");
    skipped = planner.find_skipped_pixels(number, view.frame, history.tracked_objects());
  }
  auto made = source.generate(view, number, budget.search_deadline(), skipped, planning_times);
  if (!made->left_out.empty()) planner.request_full_search();
  return made;
}

auto SceneRecognizer::Impl::merge_and_cluster(SceneUpdate& update, RecognitionTrace* trace) -> Hypotheses {
  const ScopedTimer timer(update.times, "cluster");
  Hypotheses merged = pool.merge(config.remembers() ? tracked_hypotheses() : Hypotheses{});
  update.counts.merged = static_cast<int>(merged.size());
  drop_correspondences(merged, outdated(merged));
  if (trace != nullptr) trace->merged = merged;
  Hypotheses clustered = pool.cluster(std::move(merged));
  update.counts.clustered = static_cast<int>(clustered.size());
  if (trace != nullptr) trace->clustered = clustered;
  return clustered;
}

auto SceneRecognizer::Impl::tracked_hypotheses() const -> Hypotheses {
  return planner.tracked_hypotheses(history.tracked_objects(), scene.window().front().number);
}

// Empty without change detection, and if all places are searched in each view, as in the paper.
std::vector<std::uint8_t> SceneRecognizer::Impl::outdated(const Hypotheses& hypotheses) const {
  if (!config.changes.enabled || !planner.skips_places()) return {};
  return find_outdated(hypotheses, library, changes_of(scene.window()), config.changes.removal,
                       config.verify.num_threads);
}

// Only of the hypotheses that may be present now; discards the others. Empty without change detection.
auto SceneRecognizer::Impl::find_presence(Hypotheses& hypotheses, SceneUpdate& update) const -> Mask {
  if (!config.changes.enabled) return {};
  const ScopedTimer timer(update.times, "presence");
  Mask present = compute_presence_mask(hypotheses, library, changes_of(scene.window()), config.changes.removal,
                                       config.verify.num_threads);
  discard_absent(hypotheses, present);
  return present;
}

void SceneRecognizer::Impl::verify(VerifiedHypotheses& verified, SceneUpdate& update) {
  const ScopedTimer timer(update.times, "verification");
  budget.start_verification();
  std::vector<VerificationView> views;
  for (const DynamicScene::View& view : scene.window()) views.push_back({&view.cleared});
  verified.evidence = verifier.verify(verified.hypotheses, scene.reconstruction(), views, verified.present).evidence;
  update.detections = make_detections(verified, scene.window(), library, config);
  update.counts.accepted = static_cast<int>(update.detections.size());
  budget.finish_verification(verified.hypotheses.size());
}

void SceneRecognizer::Impl::update_history(SceneUpdate& update) {
  const ScopedTimer timer(update.times, "history");
  std::vector<ObjectObservation> observed;
  for (const Detection& detection : update.detections) observed.push_back(detection.observation());
  const std::vector<ViewChanges> changes = changes_of(scene.window());
  HistoryUpdate result = history.update(update.view, observed, scene.window().back().raw, config.changes.enabled,
                                        make_find_change(library, changes, config.changes.removal));
  for (std::size_t d = 0; d < observed.size(); ++d) update.detections[d].track = result.tracks[d];
  update.events = std::move(result.events);
  planner.record(update.view, update.detections, history.tracked_objects(), pool);
}

SceneRecognizer::SceneRecognizer(const ModelLibrary& library, RecognizerConfig config,
                                 std::shared_ptr<ViewHypothesisStore> store, Clock clock)
    : impl_(std::make_unique<Impl>(library, std::move(config), std::move(store), std::move(clock))) {}
SceneRecognizer::~SceneRecognizer() = default;
SceneRecognizer::SceneRecognizer(SceneRecognizer&&) noexcept = default;

void SceneRecognizer::set_camera_errors(const CameraErrors& errors) { impl_->corrector.set(errors); }
SceneUpdate SceneRecognizer::add_view(RgbdFrame frame, RecognitionTrace* trace) {
  return impl_->add_view(std::move(frame), trace);
}
std::vector<ObjectEvent> SceneRecognizer::finish() { return impl_->history.finish(); }
const RecognizerConfig& SceneRecognizer::config() const { return impl_->config; }
const PointCloud& SceneRecognizer::reconstruction() const { return impl_->scene.reconstruction(); }

}  // namespace resight
