// SPDX-License-Identifier: Apache-2.0
#include "resight/recognition/scene_recognizer.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "resight/core/check.hpp"
#include "resight/recognition/object_history.hpp"
#include "resight/recognition/presence_mask.hpp"

namespace resight {
namespace {

// A view of the window. The raw frame is what history looks back at; the prepared view loses points as later views see
// them gone.
struct StoredView {
  int number = 0;
  RgbdFrame raw;
  PreparedView cleared;
  std::vector<Hypothesis> hypotheses;
  PointCloud removed_in_world;
  PointCloud novel_in_world;
};

}  // namespace

struct SceneRecognizer::Impl {
  Impl(const ModelLibrary& models, RecognizerConfig settings)
      : library(models),
        config((settings.check(), std::move(settings))),
        index(models, config.match),
        history(models, config.history) {}

  SceneUpdate add_view(RgbdFrame frame);
  void detect_view_changes(StoredView& current, SceneUpdate& update);
  void generate_view_hypotheses(StoredView& current, SceneUpdate& update);
  void reconstruct(SceneUpdate& update);
  [[nodiscard]] std::vector<Hypothesis> merge_and_cluster(SceneUpdate& update) const;
  [[nodiscard]] std::vector<std::uint8_t> drop_absent(std::vector<Hypothesis>& hypotheses, SceneUpdate& update) const;
  void verify(std::vector<Hypothesis> hypotheses, SceneUpdate& update) const;

  const ModelLibrary& library;
  RecognizerConfig config;
  ModelFeatureIndex index;
  ObjectHistory history;
  std::deque<StoredView> window;  // oldest first, the current view last
  Reconstruction reconstruction;  // Psi of the window
  int num_views = 0;
  std::uint64_t next_hypothesis_id = 0;
};

SceneUpdate SceneRecognizer::Impl::add_view(RgbdFrame frame) {
  SceneUpdate update;
  update.view = num_views;
  update.view_name = frame.name;
  update.world_from_camera = frame.world_from_camera;
  StoredView current;
  current.number = num_views;
  current.raw = frame;
  {
    const ScopedTimer timer(update.times, "prepare");
    current.cleared = prepare_view(std::move(frame), config.prepare);
  }
  ++num_views;
  while (static_cast<int>(window.size()) > config.num_previous_views) window.pop_front();

  generate_view_hypotheses(current, update);
  if (config.detect_changes && !window.empty()) detect_view_changes(current, update);
  window.push_back(std::move(current));
  reconstruct(update);
  verify(merge_and_cluster(update), update);

  const ScopedTimer timer(update.times, "history");
  std::vector<const RgbdFrame*> earlier;
  for (std::size_t v = 0; v + 1 < window.size(); ++v) earlier.push_back(&window[v].raw);
  update.events = history.update(update.view, update.detections, window.back().raw, earlier, config.detect_changes);
  return update;
}

// Paper Sec. III-A: features of both kinds, matched, grouped into hypotheses of this view alone.
void SceneRecognizer::Impl::generate_view_hypotheses(StoredView& current, SceneUpdate& update) {
  FeatureSet sift;
  FeatureSet shot;
  {
    const ScopedTimer timer(update.times, "sift");
    sift = extract_sift(current.cleared, config.sift);
  }
  {
    const ScopedTimer timer(update.times, "shot");
    shot = extract_shot(current.cleared, config.shot);
  }
  std::vector<std::vector<Correspondence>> correspondences;
  {
    const ScopedTimer timer(update.times, "match");
    correspondences = index.match(sift, shot);
  }
  for (const auto& c : correspondences) update.counts.correspondences += static_cast<int>(c.size());
  const ScopedTimer timer(update.times, "hypotheses");
  current.hypotheses = generate_hypotheses(correspondences, current.raw.world_from_camera, current.number,
                                           next_hypothesis_id, config.generate);
  next_hypothesis_id += current.hypotheses.size();
  update.counts.generated = static_cast<int>(current.hypotheses.size());
}

// Alg. 1, lines 1 to 5. What this view saw removed is cleared from all views before it, and from none after: an object
// put back at its old place survives.
void SceneRecognizer::Impl::detect_view_changes(StoredView& current, SceneUpdate& update) {
  const ScopedTimer timer(update.times, "changes");
  std::vector<const PreparedView*> earlier_views;
  for (const StoredView& view : window) earlier_views.push_back(&view.cleared);
  update.changes = detect_changes(reconstruction.cloud_in_world, current.cleared, config.changes, earlier_views);
  current.removed_in_world = update.changes.removed_in_world;
  current.novel_in_world = update.changes.novel_in_world;
  if (current.removed_in_world.empty()) return;
  for (StoredView& view : window)
    view.cleared = clear_removed_points(std::move(view.cleared), current.removed_in_world, config.clear_tolerance_m,
                                        config.prepare);
}

// Alg. 1, line 6.
void SceneRecognizer::Impl::reconstruct(SceneUpdate& update) {
  const ScopedTimer timer(update.times, "reconstruction");
  std::vector<const PreparedView*> views;
  for (const StoredView& view : window) views.push_back(&view.cleared);
  reconstruction = integrate_views(views, config.integrate);
  update.reconstruction_points = reconstruction.cloud_in_world.size();
}

// Paper Sec. III-A, Eq. (1). Hypotheses live in the world frame: carrying them over is collecting them.
std::vector<Hypothesis> SceneRecognizer::Impl::merge_and_cluster(SceneUpdate& update) const {
  const ScopedTimer timer(update.times, "cluster");
  std::vector<Hypothesis> merged;
  for (const StoredView& view : window) merged.insert(merged.end(), view.hypotheses.begin(), view.hypotheses.end());
  update.counts.merged = static_cast<int>(merged.size());
  if (config.cluster_hypotheses) merged = cluster_hypotheses(merged, library, config.cluster).hypotheses;
  update.counts.clustered = static_cast<int>(merged.size());
  return merged;
}

// Leaves out the hypotheses that the changes say are not there any more, and returns the presence mask of the others.
std::vector<std::uint8_t> SceneRecognizer::Impl::drop_absent(std::vector<Hypothesis>& hypotheses,
                                                             SceneUpdate& update) const {
  if (!config.detect_changes) return {};
  const ScopedTimer timer(update.times, "presence");
  std::vector<ViewChanges> changes;
  for (const StoredView& view : window) changes.push_back({view.number, &view.removed_in_world, &view.novel_in_world});
  const std::vector<std::uint8_t> mask =
      compute_presence_mask(hypotheses, library, changes, config.removal, config.verify.num_threads);
  const std::size_t num_all = hypotheses.size();
  const std::size_t now = (window.size() - 1) * num_all;
  std::vector<std::uint8_t> kept_mask;
  for (std::size_t v = 0; v < window.size(); ++v)
    for (std::size_t h = 0; h < num_all; ++h)
      if (mask[now + h] != 0) kept_mask.push_back(mask[v * num_all + h]);
  std::vector<Hypothesis> kept;
  for (std::size_t h = 0; h < num_all; ++h)
    if (mask[now + h] != 0) kept.push_back(std::move(hypotheses[h]));
  hypotheses = std::move(kept);
  return kept_mask;
}

void SceneRecognizer::Impl::verify(std::vector<Hypothesis> hypotheses, SceneUpdate& update) const {
  const std::vector<std::uint8_t> present = drop_absent(hypotheses, update);
  const ScopedTimer timer(update.times, "verification");
  std::vector<VerificationView> views;
  for (const StoredView& view : window) views.push_back({&view.cleared});
  const VerifyResult result =
      verify_hypotheses(hypotheses, library, reconstruction.cloud_in_world, views, present, config.verify);
  for (std::size_t h = 0; h < hypotheses.size(); ++h) {
    const HypothesisEvidence& evidence = result.evidence[h];
    if (!evidence.accepted) continue;
    Detection detection;
    detection.object = hypotheses[h].object;
    detection.hypothesis_id = hypotheses[h].id;
    detection.world_from_object = hypotheses[h].world_from_object;
    detection.score = evidence.score;
    detection.visible_share = evidence.visible_share;
    for (std::size_t v = 0; v < window.size(); ++v)
      detection.views.push_back({window[v].number, present.empty() || present[v * hypotheses.size() + h] != 0,
                                 evidence.visible_share_per_view[v], evidence.explained_share_per_view[v]});
    update.detections.push_back(std::move(detection));
  }
  update.counts.accepted = static_cast<int>(update.detections.size());
}

SceneRecognizer::SceneRecognizer(const ModelLibrary& library, RecognizerConfig config)
    : impl_(std::make_unique<Impl>(library, std::move(config))) {}
SceneRecognizer::~SceneRecognizer() = default;
SceneRecognizer::SceneRecognizer(SceneRecognizer&&) noexcept = default;

SceneUpdate SceneRecognizer::add_view(RgbdFrame frame) { return impl_->add_view(std::move(frame)); }
std::vector<ObjectEvent> SceneRecognizer::finish() { return impl_->history.finish(); }
const RecognizerConfig& SceneRecognizer::config() const { return impl_->config; }
const PointCloud& SceneRecognizer::reconstruction() const { return impl_->reconstruction.cloud_in_world; }

}  // namespace resight
