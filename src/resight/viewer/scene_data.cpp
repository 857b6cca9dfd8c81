// SPDX-License-Identifier: Apache-2.0
#include "resight/viewer/scene_data.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "resight/core/check.hpp"
#include "resight/geometry/mesh_sampling.hpp"
#include "resight/io/ply.hpp"
#include "resight/report/overlay.hpp"
#include "resight/viewer/binary_content.hpp"
#include "resight/viewer/internal/scene_json.hpp"
#include "resight/viewer/internal/trace_json.hpp"

namespace resight {
namespace {

constexpr std::size_t kMaxCachedBytes = std::size_t{96} << 20;
constexpr std::size_t kMaxFrames = 2;  // A view of the largest size takes 110 MB.
constexpr int kJpegQuality = 92;
constexpr double kPointsPerModel = 60000;

int find_view(const Sequence& sequence, const std::string& name) {
  for (int v = 0; v < sequence.num_views(); ++v)
    if (sequence.view_name(v) == name) return v;
  return -1;
}

/// The surface of a model that has not been trained.
Result<PointCloud> sample_model(const ModelLocation& location) {
  auto source = read_model(location);
  if (!source) return source.error();
  if (source->mesh) {
    const double size_m = diameter(source->mesh->vertices);
    return sample_surface(*source->mesh, kPointsPerModel / (size_m * size_m));
  }
  if (source->surface) return *std::move(source->surface);
  return Error{location.path.string() + ": has views only (train it to see its surface)"};
}

}  // namespace

SceneData::SceneData(ViewerScene scene) : scene_(std::move(scene)), objects_(scene_), cache_(kMaxCachedBytes) {}

Result<std::unique_ptr<SceneData>> SceneData::create(ViewerScene scene) {
  std::unique_ptr<SceneData> data(new SceneData(std::move(scene)));
  if (const auto matched = data->match_views(); !matched) return matched.error();
  return data;
}

Result<void> SceneData::match_views() {
  std::map<std::string, int> views;
  for (int v = 0; v < num_views(); ++v) views.emplace(scene_.sequence->view_name(v), v);
  for (const ViewerRun& run : scene_.runs) {
    auto& stored_views = stored_views_.emplace_back(static_cast<std::size_t>(num_views()), -1);
    for (std::size_t i = 0; i < run.results.views.size(); ++i) {
      const auto found = views.find(run.results.views[i].name);
      if (found == views.end())
        return Error{fmt::format("{}: the sequence has no view '{}' (another sequence was recognised)", run.name,
                                 run.results.views[i].name)};
      stored_views[static_cast<std::size_t>(found->second)] = static_cast<int>(i);
    }
  }
  return {};
}

int SceneData::num_views() const { return scene_.sequence ? scene_.sequence->num_views() : 0; }

int SceneData::num_objects() const {
  const std::scoped_lock lock(mutex_);
  return static_cast<int>(objects_.objects().size());
}

int SceneData::num_runs() const { return static_cast<int>(scene_.runs.size()); }

bool SceneData::has_changes() const { return !scene_.changes.empty(); }

int SceneData::revision() const {
  const std::scoped_lock lock(mutex_);
  return revision_;
}

template <typename Make>
SceneData::Content SceneData::cached(const std::string& key, const Make& make) {
  const std::scoped_lock lock(mutex_);
  if (auto known = cache_.find(key)) return known;
  Result<std::string> made = make();
  if (!made) return made.error();
  auto content = std::make_shared<const std::string>(*std::move(made));
  cache_.add(key, content);
  return content;
}

Result<SceneData::Frame> SceneData::frame(int view) {
  const auto known = std::ranges::find(frames_, view, &std::pair<int, Frame>::first);
  if (known != frames_.end()) return known->second;
  auto read = scene_.sequence->read_view(view);
  if (!read) return read.error();
  frames_.emplace_front(view, std::make_shared<const RgbdFrame>(*std::move(read)));
  if (frames_.size() > kMaxFrames) frames_.pop_back();
  return frames_.front().second;
}

SceneData::Content SceneData::index() {
  return cached("index", [&]() -> Result<std::string> {
    return viewer::format_index(scene_, objects_, stored_views_, revision_);
  });
}

SceneData::Content SceneData::view(int view, int run) {
  return cached(fmt::format("view/{}/{}", view, run), [&]() -> Result<std::string> {
    const auto shown = frame(view);
    if (!shown) return shown.error();
    const StoredView* stored = nullptr;
    viewer::SequenceNumbers numbers;
    if (run >= 0) {
      const auto& stored_views = stored_views_[static_cast<std::size_t>(run)];
      numbers = viewer::SequenceNumbers(stored_views);
      const int number = stored_views[static_cast<std::size_t>(view)];
      if (number >= 0)
        stored = &scene_.runs[static_cast<std::size_t>(run)].results.views[static_cast<std::size_t>(number)];
    }
    const auto truth = scene_.sequence->read_ground_truth(view);
    if (!truth) return truth.error();
    return viewer::format_view(scene_, objects_, **shown, stored, numbers, *truth);
  });
}

SceneData::Content SceneData::trace(int view, int run) {
  return cached(fmt::format("trace/{}/{}", view, run), [&]() -> Result<std::string> {
    const RecognitionResults& results = scene_.runs[static_cast<std::size_t>(run)].results;
    const auto& stored_views = stored_views_[static_cast<std::size_t>(run)];
    const int number = stored_views[static_cast<std::size_t>(view)];
    const viewer::SequenceNumbers numbers(stored_views);
    if (!results.trace || number < 0) return viewer::format_trace({}, objects_, numbers);
    const auto trace = results.trace->read(number, results.views[static_cast<std::size_t>(number)].name);
    if (!trace) return trace.error();
    return viewer::format_trace(*trace, objects_, numbers);
  });
}

SceneData::Content SceneData::color(int view) {
  return cached(fmt::format("color/{}", view), [&]() -> Result<std::string> {
    const auto shown = frame(view);
    if (!shown) return shown.error();
    const auto bytes = encode_jpeg((*shown)->color, kJpegQuality);
    return std::string(bytes.begin(), bytes.end());
  });
}

SceneData::Content SceneData::depth(int view) {
  return cached(fmt::format("depth/{}", view), [&]() -> Result<std::string> {
    const auto shown = frame(view);
    if (!shown) return shown.error();
    return encode_depth((*shown)->depth_m);
  });
}

SceneData::Content SceneData::surface(int object) {
  return cached(fmt::format("surface/{}", object), [&]() -> Result<std::string> {
    const auto cloud = read_surface(object);
    if (!cloud) return cloud.error();
    return encode_cloud(*cloud);
  });
}

SceneData::Content SceneData::changes(int view) {
  return cached(fmt::format("changes/{}", view), [&]() -> Result<std::string> {
    const auto cloud = read_ply_cloud(scene_.changes / (scene_.sequence->view_name(view) + ".ply"));
    if (!cloud) return cloud.error();
    return encode_cloud(*cloud);
  });
}

Result<PointCloud> SceneData::read_surface(int object) const {
  const auto index = static_cast<std::size_t>(object);
  if (scene_.library && index < scene_.library->objects.size()) return scene_.library->objects[index].surface;
  if (!scene_.library && index < scene_.models.size()) return sample_model(scene_.models[index]);
  return Error{objects_.objects()[index].name + ": has no model"};
}

Result<void> SceneData::add_view(StoredView view, std::vector<StoredEvent> events) {
  const std::scoped_lock lock(mutex_);
  require(scene_.runs.size() == 1 && scene_.sequence, "SceneData::add_view: expected one run on a sequence");
  RecognitionResults& results = scene_.runs.front().results;
  if (results.trace)
    if (const auto found = results.trace->find_new_views(); !found) return found;
  for (const StoredDetection& detection : view.detections) objects_.add(detection.object, detection.bop_id);
  const int number = find_view(*scene_.sequence, view.name);
  require(number >= 0, "SceneData::add_view: the sequence has no such view");
  stored_views_.front()[static_cast<std::size_t>(number)] = static_cast<int>(results.views.size());
  results.views.push_back(std::move(view));
  std::ranges::move(events, std::back_inserter(results.events));
  cache_.clear();
  ++revision_;
  return {};
}

void SceneData::finish(std::vector<StoredEvent> events, std::optional<TraceFile> trace) {
  const std::scoped_lock lock(mutex_);
  require(scene_.runs.size() == 1, "SceneData::finish: expected one run");
  scene_.runs.front().results.events = std::move(events);
  scene_.runs.front().results.trace = std::move(trace);
  scene_.is_live = false;
  cache_.clear();
  ++revision_;
}

}  // namespace resight
