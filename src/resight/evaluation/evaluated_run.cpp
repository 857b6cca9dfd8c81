// SPDX-License-Identifier: Apache-2.0
#include "resight/evaluation/evaluated_run.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <exception>
#include <nlohmann/json.hpp>
#include <utility>

#include "resight/core/check.hpp"
#include "resight/core/json_integer.hpp"
#include "resight/core/json_text.hpp"
#include "resight/evaluation/loss.hpp"

namespace resight {
namespace {

using Json = nlohmann::ordered_json;
using StoredJson = nlohmann::json;  // Finds a key in logarithmic time: the keys of a file may be of any number.

// Limits for numbers in files. Their sums over all views fit into the integers of the scores.
constexpr int kMaxCount = 1'000'000;
constexpr int kMaxHypotheses = 100'000'000;
constexpr std::int64_t kMaxPoints = 1'000'000'000'000;

constexpr std::array<std::pair<DetectionVerdict, std::string_view>, 4> kVerdicts{
    {{DetectionVerdict::kCorrect, "correct"},
     {DetectionVerdict::kFalsePositive, "false positive"},
     {DetectionVerdict::kGhost, "ghost"},
     {DetectionVerdict::kIgnored, "ignored"}}};

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

double size_from(const StoredJson& value) {
  const auto size = value.get<double>();
  check_not_negative("a size, distance or time", size);
  return size;
}
double optional_size_from(const StoredJson& value) {
  return value.is_null() ? std::numeric_limits<double>::quiet_NaN() : size_from(value);
}

std::int64_t integer_from(const StoredJson& value, std::int64_t least, std::int64_t largest) {
  const auto integer = json_integer(value, least, largest);
  if (!integer)
    throw std::runtime_error(value.dump() + " is no integer from " + std::to_string(least) + " to " +
                             std::to_string(largest));
  return *integer;
}
int count_from(const StoredJson& value, int largest = kMaxCount) {
  return static_cast<int>(integer_from(value, 0, largest));
}

// Of a preset or of a stage that takes time. It goes into tables as it is.
std::string plain_name_from(const StoredJson& j) {
  auto name = j.get<std::string>();
  const auto is_plain = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == ' ' || c == '-' || c == '_';
  };
  if (!std::ranges::all_of(name, is_plain)) throw std::runtime_error("'" + name + "' is no plain name");
  return name;
}

// Empty, or the name of a LossStage, which heads a column.
std::string loss_stage_from(const StoredJson& j) {
  auto name = j.get<std::string>();
  bool is_known = name.empty();
  for (int stage = 0; stage <= static_cast<int>(LossStage::kRejected); ++stage)
    is_known |= name == to_string(static_cast<LossStage>(stage));
  if (!is_known) throw std::runtime_error("unknown stage '" + name + "'");
  return name;
}

Json score_json(const RecognitionScore& s) { return {s.true_positives, s.false_positives, s.false_negatives}; }
RecognitionScore score_from(const StoredJson& j) {
  return {count_from(j.at(0)), count_from(j.at(1)), count_from(j.at(2))};
}

Json points_json(const ChangePointScore& s) { return {s.reported, s.right, s.expected, s.found}; }
ChangePointScore points_from(const StoredJson& j) {
  const auto points = [&](std::size_t i) { return static_cast<long>(integer_from(j.at(i), 0, kMaxPoints)); };
  return {points(0), points(1), points(2), points(3)};
}

Json pose_json(const Rigid3& pose) {
  Json rows = Json::array();
  const Eigen::Matrix4d m = pose.matrix();
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 4; ++c) rows.push_back(m(r, c));
  return rows;
}
Rigid3 pose_from(const StoredJson& j) {
  Rigid3 pose;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) pose.rotation(r, c) = j.at(static_cast<std::size_t>(4 * r + c)).get<double>();
    pose.translation[r] = j.at(static_cast<std::size_t>(4 * r + 3)).get<double>();
  }
  require(pose.is_rigid(), "a pose is not a rigid motion");
  return pose;
}

Json truth_json(const EvaluatedTruth& t) {
  return {{"object", t.object},
          {"instance", t.instance},
          {"visible_share", number(t.visible_share)},
          {"distance_m", t.distance_m},
          {"counts", t.counts},
          {"found", t.found},
          {"found_strictly", t.found_strictly},
          {"center_error_m", number(t.center_error_m)},
          {"rotation_error_rad", number(t.rotation_error_rad)},
          {"lost_at", t.lost_at}};
}
EvaluatedTruth truth_from(const StoredJson& j) {
  EvaluatedTruth t;
  t.object = j.at("object").get<std::string>();
  t.instance = static_cast<int>(integer_from(j.at("instance"), -1, kMaxCount));
  t.visible_share = optional_size_from(j.at("visible_share"));
  t.distance_m = size_from(j.at("distance_m"));
  t.counts = j.at("counts").get<bool>();
  t.found = j.at("found").get<bool>();
  t.found_strictly = j.at("found_strictly").get<bool>();
  t.center_error_m = optional_size_from(j.at("center_error_m"));
  t.rotation_error_rad = optional_size_from(j.at("rotation_error_rad"));
  t.lost_at = loss_stage_from(j.at("lost_at"));
  return t;
}

DetectionVerdict verdict_from(const std::string& text) {
  for (const auto& [verdict, name] : kVerdicts)
    if (name == text) return verdict;
  throw std::runtime_error("unknown verdict '" + text + "'");
}

Json counts_json(const HypothesisCounts& c) {
  return {c.correspondences, c.generated, c.merged, c.clustered, c.accepted};
}
HypothesisCounts counts_from(const StoredJson& j) {
  const auto count = [&](std::size_t i) { return count_from(j.at(i), kMaxHypotheses); };
  return {count(0), count(1), count(2), count(3), count(4)};
}

Json view_json(const EvaluatedView& view) {
  Json truth = Json::array();
  for (const EvaluatedTruth& t : view.truth) truth.push_back(truth_json(t));
  Json detections = Json::array();
  for (const EvaluatedDetection& d : view.detections)
    detections.push_back({{"object", d.object},
                          {"camera_from_object", pose_json(d.camera_from_object)},
                          {"score", d.score},
                          {"verdict", to_string(d.verdict)}});
  Json times = Json::array();
  for (const StageTime& t : view.times.stages()) times.push_back({t.stage, t.wall_s, t.cpu_s});
  return {{"name", view.name},
          {"truth", truth},
          {"detections", detections},
          {"score", score_json(view.score)},
          {"strict_score", score_json(view.strict_score)},
          {"num_detected_former_places", view.num_detected_former_places},
          {"counts", counts_json(view.counts)},
          {"removed_points", points_json(view.points.removed)},
          {"novel_points", points_json(view.points.novel)},
          {"times", times}};
}

double probability_from(const StoredJson& j) {
  const double probability = j.get<double>();
  check_in_range("score", probability, 0, 1);
  return probability;
}

EvaluatedView view_from(const StoredJson& j) {
  EvaluatedView view;
  view.name = j.at("name").get<std::string>();
  for (const StoredJson& t : j.at("truth")) view.truth.push_back(truth_from(t));
  for (const StoredJson& d : j.at("detections"))
    view.detections.push_back({d.at("object").get<std::string>(), pose_from(d.at("camera_from_object")),
                               probability_from(d.at("score")), verdict_from(d.at("verdict").get<std::string>())});
  view.score = score_from(j.at("score"));
  view.strict_score = score_from(j.at("strict_score"));
  view.num_detected_former_places = count_from(j.at("num_detected_former_places"));
  view.counts = counts_from(j.at("counts"));
  view.points = {points_from(j.at("removed_points")), points_from(j.at("novel_points"))};
  for (const StoredJson& t : j.at("times"))
    view.times.add(plain_name_from(t.at(0)), size_from(t.at(1)), size_from(t.at(2)));
  return view;
}

}  // namespace

std::string_view to_string(DetectionVerdict verdict) {
  for (const auto& [known, name] : kVerdicts)
    if (known == verdict) return name;
  return "";
}

int EvaluatedRun::num_ghosts() const {
  int count = 0;
  for (const EvaluatedView& view : views)
    for (const EvaluatedDetection& d : view.detections) count += d.verdict == DetectionVerdict::kGhost ? 1 : 0;
  return count;
}

std::string format_run(const EvaluatedRun& run) {
  Json views = Json::array();
  for (const EvaluatedView& view : run.views) views.push_back(view_json(view));
  const Json json{{"sequence", run.sequence},
                  {"preset", run.preset},
                  {"num_previous_views", run.num_previous_views},
                  {"is_clustered", run.is_clustered},
                  {"fingerprint", run.fingerprint},
                  {"num_threads", run.num_threads},
                  {"num_former_places", run.num_former_places},
                  {"num_published_places", run.num_published_places},
                  {"has_changes", run.has_changes},
                  {"events", score_json(run.events.events)},
                  {"departures", score_json(run.events.departures)},
                  {"arrivals", score_json(run.events.arrivals)},
                  {"delays_views", run.events.delays},
                  {"views", views}};
  return to_json_text(json) + "\n";
}

Result<EvaluatedRun> parse_run(std::string_view text, const std::string& name) {
  try {
    const auto j = StoredJson::parse(text);
    EvaluatedRun run;
    run.sequence = j.at("sequence").get<std::string>();
    run.preset = plain_name_from(j.at("preset"));
    run.num_previous_views = count_from(j.at("num_previous_views"));
    run.is_clustered = j.at("is_clustered").get<bool>();
    run.fingerprint = j.at("fingerprint").get<std::string>();
    run.num_threads = count_from(j.at("num_threads"));
    run.num_former_places = count_from(j.at("num_former_places"));
    run.num_published_places = count_from(j.at("num_published_places"));
    run.has_changes = j.at("has_changes").get<bool>();
    run.events = {score_from(j.at("events")), score_from(j.at("departures")), score_from(j.at("arrivals")), {}};
    for (const StoredJson& delay : j.at("delays_views")) run.events.delays.push_back(count_from(delay));
    for (const StoredJson& view : j.at("views")) run.views.push_back(view_from(view));
    return run;
  } catch (const std::exception& error) {
    return Error{name + ": is not a result of 'resight evaluate': " + error.what()};
  }
}

}  // namespace resight
