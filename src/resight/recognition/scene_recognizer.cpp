// SPDX-License-Identifier: Apache-2.0
#include "resight/recognition/scene_recognizer.hpp"

#include <algorithm>
#include <functional>
#include <iterator>
#include <map>
#include <optional>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "resight/core/check.hpp"
#include "resight/core/deadline.hpp"
#include "resight/history/object_history.hpp"
#include "resight/recognition/detection_score.hpp"
#include "resight/recognition/explained_pixels.hpp"
#include "resight/recognition/presence_mask.hpp"
#include "resight/recognition/track_correspondences.hpp"
#include "resight/recognition/view_hypothesis_generator.hpp"
#include "resight/recognition/view_novelty.hpp"
#include "resight/reconstruction/dynamic_scene.hpp"
#include "resight/verification/appearance_check.hpp"
#include "resight/verification/hypothesis_verifier.hpp"

namespace resight {
namespace {

constexpr std::size_t kFewHypotheses = 10;
constexpr std::uint64_t kFirstTrackedId = 1ULL << 40;  // Apart: ids of views are the same for all that share a store.

DynamicSceneOptions scene_options(const RecognizerConfig& config) {
  return {config.num_previous_views, config.detect_changes, config.clear_tolerance_m, config.prepare, config.changes,
          config.integrate};
}

// A view alone has nothing to be aligned to.
CorrectCameraOptions correction_options(const RecognizerConfig& config) {
  CorrectCameraOptions options = config.poses;
  options.enabled &= config.num_previous_views > 0;
  return options;
}

}  // namespace

struct SceneRecognizer::Impl {
  Impl(const ModelLibrary& models, RecognizerConfig settings, std::shared_ptr<ViewHypothesisStore> shared, Clock now)
      : library(models),
        config((settings.check(), std::move(settings))),
        history(models, config.history),
        corrector(correction_options(config)),
        scene(scene_options(config)),
        track_correspondences(static_cast<std::size_t>(config.num_previous_views) + 1,
                              config.verify.support.max_distance_m),
        attention(config.remembers() ? config.attention : AttentionOptions{}),
        verifier(models, config.verify),
        store(std::move(shared)),
        clock(std::move(now)) {
    if (!store) generator.emplace(library, config);
  }

  SceneUpdate add_view(RgbdFrame frame, RecognitionTrace* trace);
  [[nodiscard]] std::vector<Hypothesis> view_hypotheses(const PreparedView& view, SceneUpdate& update,
                                                        RecognitionTrace* trace);
  [[nodiscard]] std::vector<Hypothesis> merge_and_cluster(SceneUpdate& update, RecognitionTrace* trace);
  [[nodiscard]] bool is_tracked(const Hypothesis& hypothesis) const;
  void look_without_depth(Detection& detection) const;
  void leave_out_late(std::vector<Hypothesis>& hypotheses, SceneUpdate& update) const;
  [[nodiscard]] std::vector<Hypothesis> tracked_hypotheses();
  [[nodiscard]] Image<std::uint8_t> explained_pixels(const RgbdFrame& frame, int number, StageTimes& times);
  [[nodiscard]] bool needs_search(const TrackedObject& known, int number, double depth_m) const;
  void collect_found(const SceneUpdate& update);
  void remember_search(const SceneUpdate& update);
  [[nodiscard]] std::vector<std::uint8_t> presence_of(const std::vector<Hypothesis>& hypotheses) const;
  [[nodiscard]] std::vector<std::uint8_t> handle_removed(std::vector<Hypothesis>& hypotheses,
                                                         SceneUpdate& update) const;
  void verify(std::vector<Hypothesis> hypotheses, SceneUpdate& update, RecognitionTrace* trace);
  [[nodiscard]] bool doubts_known_object(const std::vector<Hypothesis>& hypotheses,
                                         const std::vector<HypothesisEvidence>& evidence) const;
  void forget_refuted(const std::vector<Hypothesis>& hypotheses, const std::vector<HypothesisEvidence>& evidence);

  const ModelLibrary& library;
  RecognizerConfig config;
  std::optional<ViewHypothesisGenerator> generator;  // with a store: made when a view needs it
  ObjectHistory history;
  CameraCorrector corrector;
  DynamicScene scene;
  TrackCorrespondences track_correspondences;  // used only where not each view is searched everywhere
  ViewNovelty attention;
  HypothesisVerifier verifier;
  std::shared_ptr<ViewHypothesisStore> store;              // may be null
  std::deque<std::vector<Hypothesis>> hypotheses_of_view;  // of the views in the scene's window
  std::unordered_map<std::uint64_t, std::vector<std::uint64_t>>
      members_of_cluster;                                                         // ids by the seed's id; this view's
  std::unordered_map<std::uint64_t, std::vector<Hypothesis>> found_of_detection;  // by its hypothesis; this view's
  struct Look {
    int view = -1;                // the last that was searched where a known object is
    double depth_m = 0;           // of its centre, the least of such views
    double explained_share = -1;  // of the object, by the last view
  };
  std::map<int, Look> look_of_track;  // of what is known
  int num_views = 0;
  std::uint64_t next_hypothesis_id = 0;
  std::uint64_t next_tracked_id = kFirstTrackedId;
  Clock clock;
  Deadline deadline;                     // of this view
  double verification_s = 0;             // that of the last view...
  double verification_of_each_s = 1e-9;  // ...and its share of each hypothesis; at first, next to nothing
};

SceneUpdate SceneRecognizer::Impl::add_view(RgbdFrame frame, RecognitionTrace* trace) {
  if (config.deadline_ms > 0) deadline = Deadline(1e-3 * config.deadline_ms, clock);
  SceneUpdate update;
  update.view = num_views;
  update.view_name = frame.name;
  PreparedView view;
  {
    const ScopedTimer timer(update.times, "prepare");
    view = prepare_view(std::move(frame), config.prepare);
  }
  {
    const ScopedTimer timer(update.times, "poses");
    view.frame.world_from_camera = corrector.add_view(view);
  }
  update.world_from_camera = view.frame.world_from_camera;
  ++num_views;
  {
    const ScopedTimer timer(update.times, "changes and reconstruction");  // Alg. 1
    update.changes = scene.add_view(std::move(view));
    update.searched = attention.needs_search(scene.window().back().cleared, update.changes);
  }
  hypotheses_of_view.emplace_back();
  if (update.searched) hypotheses_of_view.back() = view_hypotheses(scene.window().back().cleared, update, trace);
  while (hypotheses_of_view.size() > scene.window().size()) hypotheses_of_view.pop_front();
  update.reconstruction_points = scene.reconstruction().size();
  verify(merge_and_cluster(update, trace), update, trace);

  const ScopedTimer timer(update.times, "history");
  std::vector<ObjectObservation> observed;
  for (const Detection& detection : update.detections) observed.push_back(detection.observation());
  HistoryUpdate known = history.update(update.view, observed, scene.window().back().raw, config.detect_changes);
  for (std::size_t d = 0; d < observed.size(); ++d) update.detections[d].track = known.tracks[d];
  update.events = std::move(known.events);
  if (config.leaves_out_explained()) remember_search(update);
  std::erase_if(update.detections,
                [&](const Detection& d) { return d.views.back().confirmed_share() < config.min_reported_share; });
  return update;
}

// Those of the store, or new ones.
std::vector<Hypothesis> SceneRecognizer::Impl::view_hypotheses(const PreparedView& view, SceneUpdate& update,
                                                               RecognitionTrace* trace) {
  ViewHypotheses made;
  const ViewHypotheses* found = store ? store->find(update.view) : nullptr;
  if (found == nullptr) {
    if (!generator) generator.emplace(library, config);
    StageTimes times;
    const Image<std::uint8_t> explained = explained_pixels(view.frame, update.view, times);
    made = generator->generate(view, update.view, next_hypothesis_id, deadline.earlier_by(verification_s), explained);
    made.times.add(times);
    if (!made.left_out.empty()) {
      attention.request_search();
      look_of_track.clear();
    }
    found = store ? &store->add(update.view, std::move(made)) : &made;
  }
  update.times.add(found->times);
  update.left_out = found->left_out;
  for (const auto& c : found->correspondences) update.counts.correspondences += static_cast<int>(c.size());
  update.counts.generated = static_cast<int>(found->hypotheses.size());
  next_hypothesis_id += found->hypotheses.size();
  if (trace != nullptr) {
    trace->sift = found->sift;
    trace->shot = found->shot;
    trace->correspondences = found->correspondences;
  }
  const Rigid3& pose = view.frame.world_from_camera;
  const bool same_pose =
      found->world_from_camera.rotation == pose.rotation && found->world_from_camera.translation == pose.translation;
  return same_pose ? found->hypotheses : move_hypotheses(*found, pose);
}

std::vector<Hypothesis> SceneRecognizer::Impl::tracked_hypotheses() {
  std::vector<Hypothesis> hypotheses;
  for (const TrackedObject& known : history.tracked_objects()) {
    Hypothesis hypothesis;
    hypothesis.id = next_tracked_id++;
    hypothesis.object = known.object;
    hypothesis.world_from_object = known.world_from_object;
    hypothesis.origin_view = known.last_view;
    hypothesis.origin_views = {known.last_view};
    hypothesis.correspondences = track_correspondences.of_views(known.track, known.since_view,
                                                                scene.window().front().number, known.world_from_object);
    hypotheses.push_back(std::move(hypothesis));
  }
  return hypotheses;
}

// Whether there is something to be won: it may be something else, is new at its place, was not searched for lately, is
// nearer than ever before, or was not all that the last view showed there.
bool SceneRecognizer::Impl::needs_search(const TrackedObject& known, int number, double depth_m) const {
  const AttentionOptions& options = config.attention;
  const auto last = look_of_track.find(known.track);
  return !known.is_confirmed || last == look_of_track.end() || number - known.since_view < options.object_min_views ||
         number - last->second.view >= options.object_look_every || known.seen_view + 1 != number ||
         last->second.explained_share < options.min_sure_share ||
         depth_m * options.max_distance_ratio < last->second.depth_m;
}

// Those of known objects that need no search in this view, and that no change is near to.
Image<std::uint8_t> SceneRecognizer::Impl::explained_pixels(const RgbdFrame& frame, int number, StageTimes& times) {
  if (!config.leaves_out_explained()) return {};
  const ScopedTimer timer(times, "attention");
  const std::vector<TrackedObject> known = history.tracked_objects();
  const std::vector<std::uint8_t> present = presence_of(tracked_hypotheses());
  const std::size_t now = (scene.window().size() - 1) * known.size();
  const Rigid3 camera_from_world = frame.world_from_camera.inverse();
  std::vector<TrackedObject> confirmed;
  for (std::size_t i = 0; i < known.size(); ++i) {
    const Eigen::Vector3d center = library.objects[static_cast<std::size_t>(known[i].object)].center.cast<double>();
    const Eigen::Vector3d center_in_camera = camera_from_world * (known[i].world_from_object * center);
    const double depth_m = center_in_camera.z();
    if (!needs_search(known[i], number, depth_m) && (present.empty() || present[now + i] != 0)) {
      confirmed.push_back(known[i]);
      continue;
    }
    if (!frame.camera.contains(frame.camera.project(center_in_camera)) || center_in_camera.z() <= 0) continue;
    Look& look = look_of_track[known[i].track];
    look.depth_m = look.view < known[i].since_view ? depth_m : std::min(look.depth_m, depth_m);
    look.view = number;
  }
  return find_explained_pixels(frame, confirmed, library, config.history.presence);
}

// This view's hypotheses of what it recognised, before the weak among them are forgotten.
void SceneRecognizer::Impl::collect_found(const SceneUpdate& update) {
  found_of_detection.clear();
  for (const Detection& detection : update.detections) {
    const std::vector<std::uint64_t>& members = members_of_cluster.at(detection.hypothesis_id);
    std::ranges::copy_if(hypotheses_of_view.back(), std::back_inserter(found_of_detection[detection.hypothesis_id]),
                         [&](const Hypothesis& h) { return std::ranges::find(members, h.id) != members.end(); });
  }
}

// What this view's search found for the objects that are now known, and how sure of them it leaves us.
void SceneRecognizer::Impl::remember_search(const SceneUpdate& update) {
  std::vector<int> tracks;
  for (const TrackedObject& known : history.tracked_objects()) tracks.push_back(known.track);
  track_correspondences.keep_only(tracks);
  std::erase_if(look_of_track,
                [&](const auto& entry) { return std::ranges::find(tracks, entry.first) == tracks.end(); });
  for (const Detection& detection : update.detections) {
    if (detection.track < 0) continue;
    look_of_track[detection.track].explained_share = detection.views.back().explained_share;
    track_correspondences.add(detection.track, update.view, found_of_detection.at(detection.hypothesis_id),
                              detection.world_from_object,
                              library.objects[static_cast<std::size_t>(detection.object)].symmetries);
  }
}

// Paper Sec. III-A, Eq. (1). Hypotheses live in the world frame: carrying them over is collecting them.
std::vector<Hypothesis> SceneRecognizer::Impl::merge_and_cluster(SceneUpdate& update, RecognitionTrace* trace) {
  const ScopedTimer timer(update.times, "cluster");
  std::vector<Hypothesis> merged;
  for (const auto& of_view : hypotheses_of_view) merged.insert(merged.end(), of_view.begin(), of_view.end());
  if (config.remembers()) {
    const std::vector<Hypothesis> known = tracked_hypotheses();
    merged.insert(merged.end(), known.begin(), known.end());
  }
  update.counts.merged = static_cast<int>(merged.size());
  if (trace != nullptr) trace->merged = merged;
  members_of_cluster.clear();
  if (config.cluster_hypotheses) {
    ClusterResult clusters = cluster_hypotheses(merged, library, config.cluster);
    for (std::size_t c = 0; c < clusters.hypotheses.size(); ++c)
      for (const int m : clusters.members[c])
        members_of_cluster[clusters.hypotheses[c].id].push_back(merged[static_cast<std::size_t>(m)].id);
    merged = std::move(clusters.hypotheses);
  } else {
    for (const Hypothesis& h : merged) members_of_cluster[h.id] = {h.id};
  }
  update.counts.clustered = static_cast<int>(merged.size());
  if (trace != nullptr) trace->clustered = merged;
  return merged;
}

bool SceneRecognizer::Impl::is_tracked(const Hypothesis& hypothesis) const {
  return std::ranges::any_of(members_of_cluster.at(hypothesis.id),
                             [](std::uint64_t id) { return id >= kFirstTrackedId; });
}

// As many as there is time for by the pace of the last view, and a few however late it is: what is known, then those of
// most correspondences. The others have their turn at the next view.
void SceneRecognizer::Impl::leave_out_late(std::vector<Hypothesis>& hypotheses, SceneUpdate& update) const {
  const double in_time = deadline.left_s() / verification_of_each_s;
  const std::size_t num_all = hypotheses.size();
  if (in_time >= static_cast<double>(num_all)) return;
  const auto num_tracked =
      static_cast<std::size_t>(std::ranges::count_if(hypotheses, [&](const Hypothesis& h) { return is_tracked(h); }));
  const std::size_t num_kept =
      std::min(num_all, std::max({num_tracked, kFewHypotheses, static_cast<std::size_t>(std::max(0.0, in_time))}));
  if (num_kept == num_all) return;
  std::ranges::stable_sort(hypotheses, std::greater<>(),
                           [&](const Hypothesis& h) { return std::pair(is_tracked(h), h.correspondences.size()); });
  hypotheses.resize(num_kept);
  update.left_out.push_back("verification of " + std::to_string(num_all - num_kept) + " of " + std::to_string(num_all) +
                            " hypotheses");
}

// By view of the window and hypothesis; empty without change detection.
std::vector<std::uint8_t> SceneRecognizer::Impl::presence_of(const std::vector<Hypothesis>& hypotheses) const {
  if (!config.detect_changes) return {};
  std::vector<ViewChanges> changes;
  for (const DynamicScene::View& view : scene.window())
    changes.push_back({view.number, &view.removed_in_world, &view.novel_in_world});
  return compute_presence_mask(hypotheses, library, changes, config.removal, config.verify.num_threads);
}

// Leaves out the hypotheses that the changes say are not there any more, and returns the presence mask of the others;
// or, with judge_absent, leaves them to the newest view.
std::vector<std::uint8_t> SceneRecognizer::Impl::handle_removed(std::vector<Hypothesis>& hypotheses,
                                                                SceneUpdate& update) const {
  if (!config.detect_changes) return {};
  const ScopedTimer timer(update.times, "presence");
  const auto& window = scene.window();
  std::vector<std::uint8_t> mask = presence_of(hypotheses);
  const std::size_t num_all = hypotheses.size();
  const std::size_t now = (window.size() - 1) * num_all;
  if (config.judge_absent) {
    for (std::size_t h = 0; h < num_all; ++h) {
      if (mask[now + h] != 0) continue;
      for (std::size_t v = 0; v + 1 < window.size(); ++v) mask[v * num_all + h] = 0;
      mask[now + h] = 1;
    }
    return mask;
  }
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

// Whether something known is in sight and yet not recognised.
bool SceneRecognizer::Impl::doubts_known_object(const std::vector<Hypothesis>& hypotheses,
                                                const std::vector<HypothesisEvidence>& evidence) const {
  for (std::size_t h = 0; h < hypotheses.size(); ++h) {
    const Verdict verdict = evidence[h].verdict;
    if (verdict != Verdict::kNoSupport && verdict != Verdict::kDifferentAppearance && verdict != Verdict::kCost)
      continue;
    if (is_tracked(hypotheses[h])) return true;
  }
  return false;
}

// What was well seen and yet found no support, or has another print, is chance, and is not carried over to the next
// views.
void SceneRecognizer::Impl::forget_refuted(const std::vector<Hypothesis>& hypotheses,
                                           const std::vector<HypothesisEvidence>& evidence) {
  if (config.min_carried_share <= 0) return;
  std::unordered_set<std::uint64_t> refuted;
  for (std::size_t h = 0; h < hypotheses.size(); ++h) {
    const Verdict verdict = evidence[h].verdict;
    if (verdict == Verdict::kTooFewVisible) continue;
    if (verdict != Verdict::kDifferentAppearance && evidence[h].explained_share >= config.min_carried_share) continue;
    const auto& members = members_of_cluster.at(hypotheses[h].id);
    refuted.insert(members.begin(), members.end());
  }
  for (std::vector<Hypothesis>& of_view : hypotheses_of_view)
    std::erase_if(of_view, [&](const Hypothesis& h) { return refuted.contains(h.id); });
}

// What the newest view does not see by its depth may still be seen by its colours, unless it is looked through as much.
void SceneRecognizer::Impl::look_without_depth(Detection& detection) const {
  DetectionViewEvidence& newest = detection.views.back();
  if (newest.confirmed_share() >= config.min_reported_share) return;
  const double share = color_confirmed_share(library.objects[static_cast<std::size_t>(detection.object)],
                                             detection.world_from_object, scene.window().back().raw, config.verify);
  if (share > newest.visible_share) newest.color_share = share;
}

void SceneRecognizer::Impl::verify(std::vector<Hypothesis> hypotheses, SceneUpdate& update, RecognitionTrace* trace) {
  leave_out_late(hypotheses, update);
  const std::vector<std::uint8_t> present = handle_removed(hypotheses, update);
  const ScopedTimer timer(update.times, "verification");
  const double start_s = clock();
  const auto& window = scene.window();
  std::vector<VerificationView> views;
  for (const DynamicScene::View& view : window) views.push_back({&view.cleared});
  VerifyResult result = verifier.verify(hypotheses, scene.reconstruction(), views, present);
  for (std::size_t h = 0; h < hypotheses.size(); ++h) {
    const HypothesisEvidence& evidence = result.evidence[h];
    if (!evidence.accepted) continue;
    Detection detection;
    detection.object = hypotheses[h].object;
    detection.hypothesis_id = hypotheses[h].id;
    detection.world_from_object = evidence.world_from_object;
    detection.uncertainty = evidence.uncertainty;
    detection.score = detection_score(evidence, is_tracked(hypotheses[h]), config.score);
    detection.fit = evidence.fit;
    detection.visible_share = evidence.visible_share;
    for (std::size_t v = 0; v < window.size(); ++v)
      detection.views.push_back({window[v].number, present.empty() || present[v * hypotheses.size() + h] != 0,
                                 evidence.visible_share_per_view[v], evidence.explained_share_per_view[v], 0});
    look_without_depth(detection);
    update.detections.push_back(std::move(detection));
  }
  update.counts.accepted = static_cast<int>(update.detections.size());
  verification_s = clock() - start_s;
  if (verification_s > 0 && !hypotheses.empty())
    verification_of_each_s = verification_s / static_cast<double>(hypotheses.size());
  if (doubts_known_object(hypotheses, result.evidence)) attention.request_search();
  if (config.leaves_out_explained()) collect_found(update);
  forget_refuted(hypotheses, result.evidence);
  if (trace == nullptr) return;
  trace->verified = std::move(hypotheses);
  trace->evidence = std::move(result.evidence);
}

SceneRecognizer::SceneRecognizer(const ModelLibrary& library, RecognizerConfig config,
                                 std::shared_ptr<ViewHypothesisStore> store, Clock clock)
    : impl_(std::make_unique<Impl>(library, std::move(config), std::move(store), std::move(clock))) {}
SceneRecognizer::~SceneRecognizer() = default;
SceneRecognizer::SceneRecognizer(SceneRecognizer&&) noexcept = default;

SceneUpdate SceneRecognizer::add_view(RgbdFrame frame, RecognitionTrace* trace) {
  return impl_->add_view(std::move(frame), trace);
}
std::vector<ObjectEvent> SceneRecognizer::finish() { return impl_->history.finish(); }
const RecognizerConfig& SceneRecognizer::config() const { return impl_->config; }
const PointCloud& SceneRecognizer::reconstruction() const { return impl_->scene.reconstruction(); }

}  // namespace resight
