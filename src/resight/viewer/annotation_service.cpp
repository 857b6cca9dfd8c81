// SPDX-License-Identifier: Apache-2.0
#include "resight/viewer/annotation_service.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "resight/annotation/annotation_json.hpp"
#include "resight/annotation/color_symmetry.hpp"
#include "resight/annotation/export_annotation.hpp"
#include "resight/annotation/matched_regions.hpp"
#include "resight/annotation/place_by_click.hpp"
#include "resight/annotation/refine_over_views.hpp"
#include "resight/core/json_integer.hpp"
#include "resight/core/json_text.hpp"
#include "resight/geometry/symmetry.hpp"
#include "resight/io/parse_json.hpp"
#include "resight/viewer/internal/annotation_state_json.hpp"
#include "resight/viewer/internal/parse_number.hpp"
#include "resight/viewer/internal/view_json.hpp"

namespace resight {

struct AnnotationService::State {
  AnnotationTask task;
  ViewStore views;
  int exported_revision = -1;
};

namespace {

using nlohmann::json;

constexpr int kMaxRefinedViews = 40;
constexpr int kMaxAssessedViews = 200;
constexpr double kOfferedStep_rad = 0.5235988;  // 30 deg, about continuous axes.
constexpr std::size_t kMaxOffered = 48;

HttpResponse json_response(std::string text) {
  return {200, "application/json", std::make_shared<const std::string>(std::move(text))};
}

HttpResponse refuse(std::string why) { return make_text_response(400, std::move(why)); }

std::optional<int> whole_number(const json& body, const char* key, int count) {
  const auto found = body.find(key);
  return found == body.end() ? std::nullopt : json_integer(*found, 0, count - 1);
}

/// An object at a pose, as requests name it.
struct PosedObject {
  const ObjectModel* model = nullptr;
  Rigid3 world_from_object;
};

std::optional<PosedObject> parse_posed_object(const json& body, const ModelLibrary& library) {
  const auto object = whole_number(body, "object", static_cast<int>(library.objects.size()));
  const auto pose = body.contains("pose") ? annotation::pose_from_json(body["pose"]) : std::nullopt;
  if (!object || !pose) return std::nullopt;
  return PosedObject{&library.objects[static_cast<std::size_t>(*object)], *pose};
}

/// Some of the views from `first` to `last`, evenly, always with both ends.
std::vector<int> choose_views(int first, int last, int max_count) {
  const int count = std::min(last - first + 1, max_count);
  std::vector<int> chosen;
  for (int i = 0; i < count; ++i)
    chosen.push_back(
        count == 1 ? first : first + static_cast<int>((static_cast<std::int64_t>(last - first) * i) / (count - 1)));
  return chosen;
}

/// Views that are kept while they are used.
struct LoadedViews {
  std::vector<ViewStore::View> frames;
  std::vector<NumberedView> views;
};

Result<LoadedViews> load_views(ViewStore& store, const std::vector<int>& numbers) {
  LoadedViews loaded;
  for (const int number : numbers) {
    auto frame = store.get(number);
    if (!frame) return frame.error();
    loaded.frames.push_back(*frame);
    loaded.views.push_back({number, loaded.frames.back().get()});
  }
  return loaded;
}

json parse_body(const HttpRequest& request) {
  auto body = parse_json(request.body);
  return body.ok() && body->is_object() ? *std::move(body) : json();
}

HttpResponse answer_state(const AnnotationTask& task) {
  return json_response(viewer::format_annotation(*task.project, *task.library, task.regions));
}

HttpResponse answer_action(AnnotationTask& task, const json& body) {
  if (!body.contains("revision") || !body["revision"].is_number_integer() || !body.contains("action"))
    return refuse("expected a revision and an action");
  auto action = parse_action(to_json_text(body["action"]));
  if (!action) return refuse(action.error().message);
  const auto revision = json_integer(body["revision"], 0, std::numeric_limits<int>::max() - 1);
  const ActionOutcome outcome = task.project->act(*std::move(action), revision.value_or(-1));
  switch (outcome.kind) {
    case ActionOutcome::Kind::kApplied:
      return answer_state(task);
    case ActionOutcome::Kind::kStale:
      return make_text_response(409, outcome.message);
    case ActionOutcome::Kind::kInvalid:
      return refuse(outcome.message);
    case ActionOutcome::Kind::kNotWritten:
      break;
  }
  return make_text_response(500, outcome.message);
}

HttpResponse answer_refine(const AnnotationTask& task, ViewStore& store, const json& body) {
  const auto posed = parse_posed_object(body, *task.library);
  const auto first = whole_number(body, "first_view", store.num_views());
  const auto last = whole_number(body, "last_view", store.num_views());
  if (!posed || !first || !last || *last < *first) return refuse("expected an object, a pose and a range of views");
  const auto loaded = load_views(store, choose_views(*first, *last, kMaxRefinedViews));
  if (!loaded) return make_text_response(500, loaded.error().message);
  const auto voxel_m = static_cast<double>(task.library->surface_voxel_m);
  RefinedPlacement refined = refine_over_views(*posed->model, voxel_m, posed->world_from_object, loaded->views);
  const bool all_turns = body.contains("all_turns") && body["all_turns"] == true;
  refined.world_from_object =
      resolve_symmetry_by_color(*posed->model, voxel_m, refined.world_from_object, loaded->views,
                                all_turns ? SymmetrySearch::kAll : SymmetrySearch::kNear);
  nlohmann::ordered_json answer = {{"pose", viewer::matrix_json(refined.world_from_object)},
                                   {"num_pairs", refined.num_pairs},
                                   {"views", viewer::residuals_json(refined.views)}};
  return json_response(answer.dump());
}

HttpResponse answer_assess(const AnnotationTask& task, ViewStore& store, const json& body) {
  const auto posed = parse_posed_object(body, *task.library);
  const auto first = body.contains("first_view") ? whole_number(body, "first_view", store.num_views()) : 0;
  const auto last =
      body.contains("last_view") ? whole_number(body, "last_view", store.num_views()) : store.num_views() - 1;
  if (!posed || !first || !last || *last < *first) return refuse("expected an object, a pose and a range of views");
  nlohmann::ordered_json views = nlohmann::ordered_json::array();
  for (const int view : choose_views(*first, *last, kMaxAssessedViews)) {
    const auto loaded = load_views(store, {view});
    if (!loaded) return make_text_response(500, loaded.error().message);
    views.push_back(
        viewer::residuals_json(assess_views(*posed->model, static_cast<double>(task.library->surface_voxel_m),
                                            posed->world_from_object, loaded->views))[0]);
  }
  return json_response(views.dump());
}

HttpResponse answer_place(const AnnotationTask& task, ViewStore& store, const json& body) {
  const auto object = whole_number(body, "object", static_cast<int>(task.library->objects.size()));
  const auto view = whole_number(body, "view", store.num_views());
  if (!object || !view) return refuse("expected an object, a view and a pixel");
  const auto frame = store.get(*view);
  if (!frame) return make_text_response(500, frame.error().message);
  const auto u = whole_number(body, "u", (*frame)->camera.width);
  const auto v = whole_number(body, "v", (*frame)->camera.height);
  if (!u || !v) return refuse("expected an object, a view and a pixel");
  const auto pose = place_by_click(task.library->objects[static_cast<std::size_t>(*object)],
                                   static_cast<double>(task.library->surface_voxel_m), **frame, {*u, *v});
  if (!pose) return refuse("there is no depth at this pixel");
  return json_response(nlohmann::ordered_json{{"pose", viewer::matrix_json(*pose)}}.dump());
}

/// Motions that look the same, or have the same shape, without the identity.
HttpResponse answer_symmetries(const ObjectModel& model) {
  const ObjectSymmetries& symmetries = model.shape_symmetries.none() ? model.symmetries : model.shape_symmetries;
  nlohmann::ordered_json motions = nlohmann::ordered_json::array();
  for (const Rigid3& motion : enumerate_symmetries(symmetries, kOfferedStep_rad))
    if (!is_same_pose(motion, Rigid3::identity()) && motions.size() < kMaxOffered)
      motions.push_back(viewer::matrix_json(motion));
  return json_response(motions.dump());
}

HttpResponse answer_view(const AnnotationTask& task, ViewStore& store, int view) {
  const auto frame = store.get(view);
  if (!frame) return make_text_response(500, frame.error().message);
  return json_response(viewer::format_annotated_view(task.project->document(), *task.library, **frame, view));
}

/// The pixels of a region: as proposed, and as corrected by hand (null: not).
HttpResponse answer_region(const AnnotationTask& task, std::size_t region) {
  const RegionJudgement* judgement = match_regions(task.project->document(), task.regions).of_proposal[region];
  const bool is_corrected = judgement != nullptr && judgement->mask;
  nlohmann::ordered_json answer = {{"proposed", annotation::runs_to_json(task.regions[region].pixels)},
                                   {"corrected", nullptr}};
  if (is_corrected) answer["corrected"] = annotation::runs_to_json(*judgement->mask);
  return json_response(answer.dump());
}

HttpResponse nothing_here() { return make_text_response(404, "there is nothing under this address"); }

}  // namespace

AnnotationService::AnnotationService(AnnotationTask task) {
  auto sequence = task.sequence;
  state_ = std::make_unique<State>(State{std::move(task), ViewStore(std::move(sequence)), -1});
}
AnnotationService::~AnnotationService() = default;

const AnnotationProject& AnnotationService::project() const { return *state_->task.project; }

HttpResponse AnnotationService::answer(const HttpRequest& request, const std::vector<std::string_view>& parts) {
  AnnotationTask& task = state_->task;
  if (request.method == "GET") {
    if (parts.empty()) return answer_state(task);
    if (parts.size() != 2) return nothing_here();
    const auto number_below = [&](std::size_t count) {
      return viewer::parse_number_below(parts[1], static_cast<int>(count));
    };
    if (parts[0] == "views") {
      const auto view = number_below(static_cast<std::size_t>(state_->views.num_views()));
      return view ? answer_view(task, state_->views, *view) : nothing_here();
    }
    if (parts[0] == "symmetries") {
      const auto object = number_below(task.library->objects.size());
      return object ? answer_symmetries(task.library->objects[static_cast<std::size_t>(*object)]) : nothing_here();
    }
    const auto region = parts[0] == "regions" ? number_below(task.regions.size()) : std::nullopt;
    return region ? answer_region(task, static_cast<std::size_t>(*region)) : nothing_here();
  }
  if (parts.size() != 1) return nothing_here();
  const json body = parse_body(request);
  if (body.is_null()) return refuse("the body is not a JSON object");
  if (parts[0] == "actions") return answer_action(task, body);
  if (parts[0] == "refine") return answer_refine(task, state_->views, body);
  if (parts[0] == "assess") return answer_assess(task, state_->views, body);
  if (parts[0] == "place") return answer_place(task, state_->views, body);
  if (parts[0] != "export") return nothing_here();
  if (const auto done = save(); !done) return make_text_response(500, done.error().message);
  return json_response(to_json_text(nlohmann::ordered_json{{"folder", task.export_folder.string()}}));
}

Result<void> AnnotationService::save() {
  const AnnotationTask& task = state_->task;
  if (state_->exported_revision == task.project->revision()) return {};
  const auto summary = export_annotation(task.project->document(), *task.library, task.regions, state_->views,
                                         task.scene_name, task.export_folder);
  if (!summary) return summary.error();
  state_->exported_revision = task.project->revision();
  return {};
}

}  // namespace resight
