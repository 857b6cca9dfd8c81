// SPDX-License-Identifier: Apache-2.0
#include "resight/cameras/track_journal.hpp"

#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <string_view>
#include <utility>

#include "resight/core/files.hpp"
#include "resight/core/input_file.hpp"
#include "resight/core/json_integer.hpp"
#include "resight/core/json_text.hpp"

namespace resight {
namespace {

using nlohmann::ordered_json;

constexpr const char* kFormat = "resight track journal 1";

template <typename Matrix>
ordered_json to_json(const Matrix& m) {
  ordered_json values = ordered_json::array();
  for (Eigen::Index i = 0; i < m.size(); ++i) values.push_back(m.data()[i]);
  return values;
}

ordered_json pose_json(const Rigid3& pose) {
  return {{"rotation", to_json(pose.rotation)}, {"translation", to_json(pose.translation)}};
}

int read_integer(const nlohmann::json& value, int least, int largest) {
  const auto integer = json_integer(value, least, largest);
  if (!integer) throw std::out_of_range("no whole number of this range");
  return *integer;
}

template <typename Matrix>
void read_matrix(const ordered_json& values, Matrix& m) {
  if (static_cast<Eigen::Index>(values.size()) != m.size()) throw std::out_of_range("wrong number of values");
  for (Eigen::Index i = 0; i < m.size(); ++i) m.data()[i] = values.at(static_cast<std::size_t>(i)).get<double>();
  if (!m.allFinite()) throw std::out_of_range("a value is not finite");
}

Rigid3 read_pose(const ordered_json& values) {
  Rigid3 pose;
  read_matrix(values.at("rotation"), pose.rotation);
  read_matrix(values.at("translation"), pose.translation);
  if (!pose.is_rigid()) throw std::out_of_range("no rigid motion");
  return pose;
}

std::string to_line(const TrackerStep& step) {
  const TrackedView& v = step.view;
  ordered_json edges = ordered_json::array();
  for (const PoseEdge& e : step.edges)
    edges.push_back(
        {{"a", e.a}, {"b", e.b}, {"a_from_b", pose_json(e.a_from_b)}, {"information", to_json(e.information)}});
  const ordered_json line{{"name", v.name},
                          {"world_from_camera", pose_json(v.world_from_camera)},
                          {"component", v.component},
                          {"is_keyframe", v.is_keyframe},
                          {"num_matches", v.num_matches},
                          {"overlap", v.overlap},
                          {"sigma", to_json(v.sigma)},
                          {"edges", edges}};
  return to_json_text(line) + "\n";
}

// Reads one step. Edges may lead from earlier views only. None if the line is damaged.
std::optional<TrackerStep> read_line(const std::string& line, int view) {
  try {
    const auto values = nlohmann::json::parse(line);  // Not ordered: it finds a key fast among any number of them.
    TrackerStep step;
    step.view.name = values.at("name").get<std::string>();
    step.view.world_from_camera = read_pose(values.at("world_from_camera"));
    step.view.component = read_integer(values.at("component"), 0, view);
    step.view.is_keyframe = values.at("is_keyframe").get<bool>();
    step.view.num_matches = read_integer(values.at("num_matches"), -1, std::numeric_limits<int>::max());
    step.view.overlap = values.at("overlap").get<double>();
    read_matrix(values.at("sigma"), step.view.sigma);
    for (const nlohmann::json& e : values.at("edges")) {
      PoseEdge edge{.a = read_integer(e.at("a"), 0, view - 1),
                    .b = read_integer(e.at("b"), view, view),
                    .a_from_b = read_pose(e.at("a_from_b")),
                    .information = {}};
      read_matrix(e.at("information"), edge.information);
      step.edges.push_back(edge);
    }
    return step;
  } catch (const ordered_json::exception&) {
    return std::nullopt;
  } catch (const std::out_of_range&) {
    return std::nullopt;
  }
}

std::string head_line(const std::string& job) {
  return to_json_text(ordered_json{{"format", kFormat}, {"job", job}}) + "\n";
}

// Whether the first line is the head of any journal. A head that was cut off while it was written counts.
bool is_journal(std::string_view text) {
  const std::string head = to_json_text(ordered_json{{"format", kFormat}});
  const std::string_view begin = std::string_view(head).substr(0, head.size() - 1);  // Without the brace.
  return text.starts_with(begin) || begin.starts_with(text);
}

std::vector<TrackerStep> read_steps(const std::string& text, const std::string& job) {
  std::vector<TrackerStep> steps;
  std::istringstream in(text);
  std::string line;
  if (!std::getline(in, line) || line + "\n" != head_line(job)) return steps;
  while (std::getline(in, line) && !in.eof()) {  // At the end of the file: the last line is incomplete.
    std::optional<TrackerStep> step = read_line(line, static_cast<int>(steps.size()));
    if (!step) break;
    steps.push_back(std::move(*step));
  }
  return steps;
}

}  // namespace

Result<TrackJournal> TrackJournal::open(std::filesystem::path file, std::string job) {
  std::error_code none;
  if (std::filesystem::symlink_status(file, none).type() == std::filesystem::file_type::not_found)
    return TrackJournal(std::move(file), std::move(job), {});
  const auto text = read_file(file);
  if (!text) return text.error();
  if (!is_journal(*text))
    return file_error(file, "exists already and is no journal of 'resight track'; rename it or choose another output");
  std::vector<TrackerStep> steps = read_steps(*text, job);
  return TrackJournal(std::move(file), std::move(job), std::move(steps));
}

// Rewrites the file without its unreadable lines.
Result<void> TrackJournal::begin() {
  std::string text = head_line(job_);
  for (const TrackerStep& step : steps_) text += to_line(step);
  if (auto done = write_file(file_, text); !done) return done;
  out_.open(file_, std::ios::binary | std::ios::app);
  return {};
}

Result<void> TrackJournal::append(const TrackerStep& step) {
  if (!out_.is_open())
    if (auto done = begin(); !done) return done;
  out_ << to_line(step) << std::flush;
  if (!out_) return file_error(file_, "cannot be written");
  return {};
}

void TrackJournal::remove() {
  out_.close();
  std::error_code ignored;
  std::filesystem::remove(file_, ignored);
}

}  // namespace resight
