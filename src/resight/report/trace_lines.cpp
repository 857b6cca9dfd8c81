// SPDX-License-Identifier: Apache-2.0
#include "resight/report/trace_lines.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <vector>

#include "resight/core/check.hpp"
#include "resight/core/json_text.hpp"
#include "resight/evaluation/loss.hpp"
#include "resight/report/internal/json_values.hpp"
#include "resight/verification/failed_test.hpp"

namespace resight {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kPoseSteps = 1e7;   // Poses in a trace are to be looked at: 0.1 um.
constexpr double kShareSteps = 1e4;  // Shares and similarities.

double round_to(double value, double steps) { return std::round(value * steps) / steps; }

Json rounded(const Rigid3& pose) {
  Rigid3 short_pose;
  short_pose.rotation = pose.rotation.unaryExpr([](double value) { return round_to(value, kPoseSteps); });
  short_pose.translation = pose.translation.unaryExpr([](double value) { return round_to(value, kPoseSteps); });
  return report::pose_json(short_pose);
}
Json rounded(double value) { return round_to(value, kShareSteps); }

/// A hypothesis after clustering and, if it was verified, its number there.
struct TracedHypothesis {
  const Hypothesis* start = nullptr;
  int verified = -1;
};

std::vector<TracedHypothesis> find_hypotheses(const RecognitionTrace& trace) {
  std::map<std::uint64_t, int> verified;
  for (std::size_t h = 0; h < trace.verified.size(); ++h) verified.emplace(trace.verified[h].id, static_cast<int>(h));
  std::vector<TracedHypothesis> found;
  for (const Hypothesis& start : trace.clustered) {
    const auto known = verified.find(start.id);
    found.push_back({&start, known == verified.end() ? -1 : known->second});
  }
  return found;
}

/// Those that are listed, the most important ones first.
std::vector<TracedHypothesis> choose_hypotheses(const RecognitionTrace& trace, const std::vector<Loss>& losses) {
  std::vector<TracedHypothesis> chosen = find_hypotheses(trace);
  const auto rank = [&](const TracedHypothesis& h) {
    if (h.verified < 0) return 0.0;
    const bool is_named = std::ranges::any_of(losses, [&](const Loss& loss) { return loss.verified == h.verified; });
    const HypothesisEvidence& e = trace.evidence[static_cast<std::size_t>(h.verified)];
    return (e.accepted ? 4.0 : 0.0) + (is_named ? 2.0 : 0.0) + e.fit;
  };
  std::ranges::stable_sort(chosen, std::ranges::greater(), rank);
  if (chosen.size() > kMaxTracedHypotheses) chosen.resize(kMaxTracedHypotheses);
  return chosen;
}

/// Number in the list by number of the verification.
std::vector<int> number_listed(const std::vector<TracedHypothesis>& chosen, std::size_t num_verified) {
  std::vector<int> numbers(num_verified, -1);
  for (std::size_t i = 0; i < chosen.size(); ++i)
    if (chosen[i].verified >= 0) numbers[static_cast<std::size_t>(chosen[i].verified)] = static_cast<int>(i);
  return numbers;
}

Json listed_json(const std::vector<int>& numbers, int verified) {
  const int number = verified < 0 ? -1 : numbers[static_cast<std::size_t>(verified)];
  return number < 0 ? Json(nullptr) : Json(number);
}

Json failed_test_json(const HypothesisEvidence& evidence, const AcceptanceOptions& acceptance) {
  // Another hypothesis keeps it out: it may have failed none.
  const auto failed = evidence.accepted || evidence.verdict == Verdict::kSuppressed
                          ? std::nullopt
                          : find_failed_test(evidence, acceptance);
  if (!failed) return nullptr;
  return {{"quantity", failed->quantity}, {"value", rounded(failed->value)}, {"limit", rounded(failed->limit)}};
}

/// The views of the window, the oldest first, end with the current one.
Json window_json(const HypothesisEvidence& evidence, int view) {
  Json views = Json::array();
  const int num_views = static_cast<int>(evidence.visible_share_per_view.size());
  for (int v = 0; v < num_views; ++v)
    views.push_back({{"view", view - num_views + 1 + v},
                     {"visible_share", rounded(evidence.visible_share_per_view[static_cast<std::size_t>(v)])},
                     {"explained_share", rounded(evidence.explained_share_per_view[static_cast<std::size_t>(v)])}});
  return views;
}

void add_evidence(const HypothesisEvidence& e, const TracedView& view, const std::vector<int>& numbers, Json& json) {
  json["world_from_object"] = rounded(e.world_from_object);
  json["test"] = failed_test_json(e, *view.acceptance);
  json["suppressed_by"] = listed_json(numbers, e.suppressed_by);
  json["score"] = rounded(e.score);
  json["fit"] = rounded(e.fit);
  json["visible_share"] = rounded(e.visible_share);
  json["explained_share"] = rounded(e.explained_share);
  json["pattern_similarity"] = rounded(e.appearance.pattern_similarity);
  json["newest_similarity"] = rounded(e.appearance.newest_similarity);
  json["shared_texture"] = rounded(e.appearance.shared_texture);
  json["texture_contrast"] = rounded(e.appearance.texture_contrast);
  json["explained_scene"] = rounded(e.costs.explained_scene);
  json["outlier"] = rounded(e.costs.outlier);
  json["clutter"] = rounded(e.costs.clutter);
  json["plane"] = rounded(e.costs.plane);
  json["views"] = window_json(e, view.update->view);
}

const char* verdict_of(const TracedHypothesis& hypothesis, const TracedView& view) {
  if (hypothesis.verified < 0) return "not verified";
  const HypothesisEvidence& e = view.trace->evidence[static_cast<std::size_t>(hypothesis.verified)];
  const bool is_reported = std::ranges::any_of(
      view.update->detections, [&](const Detection& d) { return d.hypothesis_id == hypothesis.start->id; });
  return e.accepted && !is_reported ? "held back" : to_string(e.verdict);
}

Json hypothesis_json(const TracedHypothesis& hypothesis, const TracedView& view, const std::vector<int>& numbers,
                     const ModelLibrary& library) {
  const Hypothesis& start = *hypothesis.start;
  Json json = {{"object", library.objects[static_cast<std::size_t>(start.object)].name},
               {"verdict", verdict_of(hypothesis, view)},
               {"origin_views", start.origin_views},
               {"correspondences", start.correspondences.size()},
               {"start", rounded(start.world_from_object)}};
  if (hypothesis.verified >= 0)
    add_evidence(view.trace->evidence[static_cast<std::size_t>(hypothesis.verified)], view, numbers, json);
  return json;
}

Json loss_json(const GroundTruthObject& truth, const Loss& loss, const TracedView& view,
               const std::vector<int>& numbers) {
  return {{"object", truth.object},
          {"world_from_object", rounded(view.update->world_from_camera * truth.camera_from_object)},
          {"visible_share", rounded(truth.visible_share)},
          {"stage", to_string(loss.stage)},
          {"keypoints", loss.num_keypoints},
          {"correspondences", loss.num_correspondences},
          {"right_correspondences", loss.num_right},
          {"center_error_m", loss.best ? Json(round_to(loss.best->center_distance_m, kPoseSteps)) : Json(nullptr)},
          {"rotation_error_rad", loss.best ? rounded(loss.best->rotation_rad) : Json(nullptr)},
          {"hypothesis", listed_json(numbers, loss.verified)}};
}

}  // namespace

std::string format_trace_header(const std::string& preset, const std::string& version) {
  return to_json_text<Json>({{"format", "resight trace 2"}, {"version", version}, {"preset", preset}});
}

std::string format_trace_line(const TracedView& view, const ModelLibrary& library) {
  require(view.update != nullptr && view.trace != nullptr && view.acceptance != nullptr,
          "format_trace_line: the view lacks its update, trace or options");
  std::vector<Loss> losses;
  for (const GroundTruthObject& truth : view.missed)
    losses.push_back(find_loss(truth, view.update->world_from_camera, *view.trace, library));
  const std::vector<TracedHypothesis> chosen = choose_hypotheses(*view.trace, losses);
  const std::vector<int> numbers = number_listed(chosen, view.trace->verified.size());
  const HypothesisCounts& counts = view.update->counts;
  Json json = {{"view", view.update->view},
               {"name", view.update->view_name},
               {"searched", view.update->searched},
               {"generated", counts.generated},
               {"merged", counts.merged},
               {"clustered", counts.clustered},
               {"verified", view.trace->verified.size()}};
  json["hypotheses"] = Json::array();
  for (const TracedHypothesis& hypothesis : chosen)
    json["hypotheses"].push_back(hypothesis_json(hypothesis, view, numbers, library));
  json["lost"] = Json::array();
  for (std::size_t i = 0; i < losses.size(); ++i)
    json["lost"].push_back(loss_json(view.missed[i], losses[i], view, numbers));
  return to_json_text<Json>(json);
}

}  // namespace resight
