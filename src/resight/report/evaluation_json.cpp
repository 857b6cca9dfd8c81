// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

#include "resight/report/evaluation_report.hpp"
#include "resight/report/internal/json_values.hpp"

namespace resight {
namespace {

using report::score_json;
using report::to_text;
using Json = nlohmann::ordered_json;

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json points_json(const ChangePointScore& score) {
  return {{"reported", score.reported},
          {"right", score.right},
          {"expected", score.expected},
          {"found", score.found},
          {"precision", number(score.precision())},
          {"recall", number(score.recall())}};
}

Json found_json(const FoundCount& count) {
  return {{"found", count.found},
          {"missed", count.missed},
          {"false_positives", count.false_positives},
          {"lost_at", count.lost_at}};
}

Json changes_json(const ConfigurationSummary& c) {
  if (!c.changes.are_scored) return nullptr;
  const auto& delays = c.changes.events.delays;
  return {{"removed_points", points_json(c.changes.points.removed)},
          {"novel_points", points_json(c.changes.points.novel)},
          {"events", score_json(c.changes.events.events)},
          {"departures", score_json(c.changes.events.departures)},
          {"arrivals", score_json(c.changes.events.arrivals)},
          {"mean_delay_views", delays.empty() ? Json(nullptr)
                                              : Json(std::accumulate(delays.begin(), delays.end(), 0.0) /
                                                     static_cast<double>(delays.size()))},
          {"max_delay_views", delays.empty() ? Json(nullptr) : Json(*std::ranges::max_element(delays))}};
}

Json reliability_json(const Reliability& reliability) {
  Json bins = Json::array();
  for (const ScoreBin& bin : reliability.bins())
    bins.push_back({{"from", bin.from},
                    {"detections", bin.count()},
                    {"mean_score", number(bin.mean_score())},
                    {"share_right", number(bin.share_right())}});
  return {{"calibration_error", number(reliability.calibration_error())}, {"by_score", bins}};
}

Json key_json(const ConfigurationSummary& c) {
  return {{"preset", c.preset}, {"num_previous_views", c.num_previous_views}, {"is_clustered", c.is_clustered}};
}

Json configuration_json(const ConfigurationSummary& c) {
  Json json = key_json(c);
  json["num_sequences"] = c.num_sequences;
  json["num_views"] = c.num_views;
  json["score_5cm_30deg"] = score_json(c.score);
  json["score_1cm_10deg"] = score_json(c.strict_score);
  json["center_error_m"] = {{"median", number(c.errors.center_m.median)}, {"p95", number(c.errors.center_m.p95)}};
  json["rotation_error_rad"] = {{"median", number(c.errors.rotation_rad.median)},
                                {"p95", number(c.errors.rotation_rad.p95)}};
  json["ghosts"] = {{"detections", c.ghosts.num_detections},
                    {"former_places", c.ghosts.num_former_places},
                    {"per_former_place", number(c.ghosts.per_former_place())},
                    {"by_published_rule", c.ghosts.num_by_published_rule},
                    {"places_by_published_rule", c.ghosts.num_published_places}};
  json["reliability"] = reliability_json(c.reliability);
  json["hypotheses"] = {{"correspondences", c.counts.correspondences},
                        {"generated", c.counts.generated},
                        {"merged", c.counts.merged},
                        {"clustered", c.counts.clustered},
                        {"accepted", c.counts.accepted}};
  json["changes"] = changes_json(c);
  json["lost_at"] = c.found.lost_at;
  json["by_object"] = Json::object();
  for (const auto& [name, count] : c.found.by_object) json["by_object"][name] = found_json(count);
  json["by_visible_share"] = Json::array();
  for (std::size_t i = 0; i < c.found.by_visible_share.size(); ++i) {
    Json bin = {{"from", i < visible_share_bins().size() ? Json(visible_share_bins()[i]) : Json(nullptr)}};
    bin.update(found_json(c.found.by_visible_share[i]));
    json["by_visible_share"].push_back(bin);
  }
  return json;
}

Json times_json(const ConfigurationSummary& c) {
  Json json = key_json(c);
  json["num_views"] = c.num_views;
  json["num_threads"] = c.times.num_threads;
  json["seconds_per_view"] = number(c.times.stages.total_wall_s() / c.num_views);
  json["stages"] = Json::array();
  for (const StageTime& stage : c.times.stages.stages())
    json["stages"].push_back({{"stage", stage.stage},
                              {"wall_s_per_view", number(stage.wall_s / c.num_views)},
                              {"cpu_s_per_view", number(stage.cpu_s / c.num_views)}});
  json["seconds_by_view_number"] = c.times.mean_view_wall_s;
  return json;
}

Json document(const EvaluationHeader& header) {
  return {{"format", "resight evaluation 1"}, {"dataset", header.dataset}, {"version", header.version}};
}

}  // namespace

std::string format_evaluation_json(const EvaluationHeader& header,
                                   std::span<const ConfigurationSummary> configurations) {
  Json json = document(header);
  json["configurations"] = Json::array();
  for (const ConfigurationSummary& c : configurations) json["configurations"].push_back(configuration_json(c));
  return to_text(json);
}

std::string format_evaluation_times_json(const EvaluationHeader& header,
                                         std::span<const ConfigurationSummary> configurations) {
  Json json = document(header);
  json["configurations"] = Json::array();
  for (const ConfigurationSummary& c : configurations) json["configurations"].push_back(times_json(c));
  return to_text(json);
}

}  // namespace resight
