// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <vector>

#include "commands.hpp"
#include "resight/core/files.hpp"
#include "resight/core/input_file.hpp"
#include "resight/core/json_text.hpp"
#include "resight/core/unfinished_folder.hpp"
#include "resight/io/model_source.hpp"
#include "resight/models/library_file.hpp"
#include "resight/recordings/recording.hpp"
#include "resight/training/training.hpp"
#include "sequence_input.hpp"

namespace resight::app {
namespace {

using Json = nlohmann::ordered_json;

// Three digits behind the point: metres to the millimetre.
double rounded(double value) { return std::round(1000 * value) / 1000; }

Json describe_depth(const RgbdFrame& frame) {
  std::vector<float> depths;
  for (const float z : frame.depth_m.data())
    if (!std::isnan(z)) depths.push_back(z);
  Json json;
  json["measured_share"] = rounded(static_cast<double>(depths.size()) / static_cast<double>(frame.depth_m.size()));
  if (depths.empty()) return json;
  std::ranges::sort(depths);
  json["nearest_m"] = rounded(depths.front());
  json["median_m"] = rounded(depths[depths.size() / 2]);
  json["farthest_m"] = rounded(depths.back());
  return json;
}

Json describe_poses(const Sequence& sequence) {
  Json json;
  json["given"] = sequence.has_poses();
  if (!sequence.has_poses()) return json;
  std::optional<Rigid3> before;
  double path_m = 0;
  Eigen::AlignedBox3d extent;
  for (int v = 0; v < sequence.num_views(); ++v) {
    const Rigid3 pose = value_or_throw(sequence.read_pose(v));
    if (before) path_m += (pose.translation - before->translation).norm();
    extent.extend(pose.translation);
    before = pose;
  }
  const Eigen::Vector3d size = extent.sizes();
  json["path_m"] = rounded(path_m);
  json["extent_m"] = {rounded(size.x()), rounded(size.y()), rounded(size.z())};
  return json;
}

Json describe_sequence(const Sequence& sequence) {
  const RgbdFrame first = value_or_throw(sequence.read_view(0));
  Json json;
  json["format"] = sequence.format();
  json["views"] = sequence.num_views();
  json["first_view"] = sequence.view_name(0);
  json["last_view"] = sequence.view_name(sequence.num_views() - 1);
  json["image_px"] = {first.camera.width, first.camera.height};
  json["intrinsics_px"] = {
      {"fx", first.camera.fx}, {"fy", first.camera.fy}, {"cx", first.camera.cx}, {"cy", first.camera.cy}};
  json["depth_of_first_view"] = describe_depth(first);
  json["poses"] = describe_poses(sequence);
  if (sequence.has_ground_truth()) {
    std::set<std::string> names;
    for (int v = 0; v < sequence.num_views(); ++v)
      for (const GroundTruthObject& object : value_or_throw(sequence.read_ground_truth(v))) names.insert(object.object);
    if (!names.empty()) json["true_objects"] = names;
  }
  if (const auto notes = sequence.notes(); !notes.empty()) json["notes"] = notes;
  return json;
}

Json describe_recording(const Recording& recording) {
  struct TopicTimes {
    std::int64_t count = 0, first_ns = 0, last_ns = 0;
  };
  std::vector<TopicTimes> times(recording.topics().size());
  for (const MessageEntry& entry : recording.messages()) {
    TopicTimes& t = times[static_cast<std::size_t>(entry.topic)];
    if (t.count++ == 0) t.first_ns = t.last_ns = entry.time_ns;
    t.first_ns = std::min(t.first_ns, entry.time_ns);
    t.last_ns = std::max(t.last_ns, entry.time_ns);
  }
  Json json;
  json["format"] = recording.format();
  json["messages"] = recording.messages().size();
  json["topics"] = Json::array();
  for (std::size_t i = 0; i < times.size(); ++i) {
    const double seconds = (static_cast<double>(times[i].last_ns) - static_cast<double>(times[i].first_ns)) * 1e-9;
    Json topic = {
        {"name", recording.topics()[i].name}, {"type", recording.topics()[i].type}, {"messages", times[i].count}};
    if (times[i].count > 1 && seconds > 0)
      topic["rate_hz"] = rounded(static_cast<double>(times[i].count - 1) / seconds);
    json["topics"].push_back(std::move(topic));
  }
  if (!recording.damage().empty()) json["damage"] = recording.damage();
  return json;
}

Json describe_library(const ModelLibrary& library) {
  Json json;
  json["objects"] = Json::array();
  for (const ObjectModel& object : library.objects)
    json["objects"].push_back({{"name", object.name},
                               {"obj_id", object.bop_id},
                               {"diameter_m", rounded(object.diameter_m)},
                               {"surface_points", object.surface.size()},
                               {"sift_features", object.sift.size()},
                               {"shot_features", object.shot.size()}});
  return json;
}

std::vector<double> rounded_extent_m(const std::vector<Eigen::Vector3f>& points) {
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& p : points) box.extend(p);
  const Eigen::Vector3f size = box.sizes();
  return {rounded(size.x()), rounded(size.y()), rounded(size.z())};
}

// A model that cannot be read, beside others that can, says why: a wrong unit, for example.
Json describe_model(const ModelLocation& location) {
  Json json = {{"name", location.name}, {"format", location.format}, {"path", location.path.string()}};
  const auto model = read_model(location);
  if (!model.ok()) {
    json["error"] = model.error().message;
    return json;
  }
  if (model->mesh) {
    json["extent_m"] = rounded_extent_m(model->mesh->vertices);
    json["vertices"] = model->mesh->vertices.size();
    json["faces"] = model->mesh->faces.size();
    json["textured"] = model->mesh->has_texture();
  } else if (model->surface) {
    json["extent_m"] = rounded_extent_m(model->surface->points);
    json["points"] = model->surface->size();
  }
  if (!model->views.empty()) json["views"] = model->views.size();
  if (!model->warnings.empty()) json["warnings"] = model->warnings;
  return json;
}

Json describe_models(const std::vector<ModelLocation>& models) {
  Json json;
  json["models"] = Json::array();
  for (const ModelLocation& model : models) json["models"].push_back(describe_model(model));
  const Json& described = json["models"];
  if (std::ranges::all_of(described, [](const Json& model) { return model.contains("error"); }))
    throw InputError(described.front()["error"].get<std::string>());
  return json;
}

// Numbers and texts of a results file, without its lists. The parser takes the square of the number of keys of an
// object and of the objects of a list: those inside others are left out, and a file of very many keys is none of ours.
Json describe_results(const std::filesystem::path& file) {
  constexpr int kMaxKeys = 1000;
  int num_keys = 0;
  using Event = Json::parse_event_t;
  const auto is_kept = [&](int depth, Event event, const Json&) {
    if (event == Event::object_start || event == Event::array_start) return depth == 0;
    return event != Event::key || (depth == 1 && ++num_keys <= kMaxKeys);
  };
  const Json all = Json::parse(value_or_throw(read_file(file)), is_kept, false);
  if (num_keys > kMaxKeys) throw InputError(file_error(file, "has too many keys for results of resight").message);
  if (!all.is_object()) throw InputError(file_error(file, "is not valid JSON").message);
  Json json;
  for (const auto& [name, value] : all.items())
    if (value.is_primitive()) json[name] = value;
  return json;
}

struct Described {
  std::string kind;
  Json content;
};

Described describe_recorded(const InfoArguments& arguments) {
  const auto recording = value_or_throw(open_recording(arguments.path));
  Json json = describe_recording(*recording);
  // Its topics help to choose, also where its views cannot be found yet.
  const auto sequence = open_sequence(arguments.path, arguments.input);
  if (sequence.ok())
    json["sequence"] = describe_sequence(**sequence);
  else
    json["sequence_error"] = sequence.error().message;
  return {"recording", std::move(json)};
}

Described describe(const InfoArguments& arguments) {
  const std::filesystem::path& path = arguments.path;
  value_or_throw(check_finished(path));
  const auto start = read_file_start(path, kLibrarySignature.size());
  if (start.ok() && *start == kLibrarySignature)
    return {"model library", describe_library(value_or_throw(load_library(path, TrainOptions{}.hash())))};
  if (is_recording(path)) return describe_recorded(arguments);
  for (const char* name : {"summary.json", "results.json", "changes.json"})
    if (std::filesystem::exists(path / name)) return {"results", describe_results(path / name)};
  const auto sequence = open_sequence(path, arguments.input);
  if (sequence.ok()) return {"sequence", describe_sequence(**sequence)};
  // Models beside a damaged sequence, or beside several, do not stand for them.
  if (value_or_throw(find_sequence_folder(path))) throw InputError(sequence.error().message);
  if (const auto models = find_models_to_show(path)) return {"models", describe_models(*models)};
  throw InputError(sequence.error().message);
}

std::string to_line(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
  std::string line;
  if (value.is_object())
    for (const auto& [name, item] : value.items()) line += (line.empty() ? "" : ", ") + name + " " + to_line(item);
  else if (value.is_array())
    for (const Json& item : value) line += (line.empty() ? "" : ", ") + to_line(item);
  else
    line = value.dump();
  return line;
}

// One line per value; lists of things have one line each.
void print_lines(const Json& json) {
  for (const auto& [name, value] : json.items()) {
    if (name == "sequence" && value.is_object()) {
      print_lines(value);
    } else if (value.is_array() && !value.empty() && (value.front().is_object() || name == "notes")) {
      print("{}:\n", name);
      for (const Json& item : value) print("  {}\n", to_line(item));
    } else {
      print("{}: {}\n", name, to_line(value));
    }
  }
}

}  // namespace

void run_info(const InfoArguments& arguments) {
  Described described = describe(arguments);
  if (arguments.as_json) {
    Json json = {{"path", arguments.path.string()}, {"kind", described.kind}};
    json.update(described.content);
    print_json(to_json_text(json, kIndentedJson) + "\n");
    return;
  }
  print("{}: {}\n", arguments.path.string(), described.kind);
  print_lines(described.content);
}

}  // namespace resight::app
