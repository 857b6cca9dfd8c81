// SPDX-License-Identifier: Apache-2.0
#include "resight/viewer/viewer_routes.hpp"

#include <optional>
#include <string_view>
#include <vector>

#include "resight/viewer/access_guard.hpp"
#include "resight/viewer/assets.hpp"
#include "resight/viewer/internal/parse_number.hpp"

namespace resight {
namespace {

constexpr const char* kJson = "application/json";
constexpr const char* kBinary = "application/octet-stream";

std::vector<std::string_view> split_path(std::string_view path) {
  std::vector<std::string_view> parts;
  while (!path.empty()) {
    path.remove_prefix(1);  // the slash
    const std::size_t end = path.find('/');
    parts.push_back(path.substr(0, end));
    path.remove_prefix(end == path.npos ? path.size() : end);
  }
  return parts;
}

using viewer::parse_number_below;

HttpResponse not_found() { return make_text_response(404, "there is nothing under this address"); }

HttpResponse respond(const char* type, const SceneData::Content& content) {
  if (!content) return make_text_response(500, content.error().message);
  return {200, type, *content};
}

/// Each event is the revision of the scene.
HttpResponse start_events(const SceneData& scene) {
  return {.status = 200,
          .content_type = "text/event-stream",
          .body = std::make_shared<const std::string>(std::to_string(scene.revision())),
          .allowed_methods = "GET",
          .is_event_stream = true};
}

/// Addresses below /api/views/.
HttpResponse answer_view(SceneData& scene, const std::vector<std::string_view>& parts, const HttpRequest& request) {
  const auto view = parse_number_below(parts[2], scene.num_views());
  if (!view) return not_found();
  const auto asked = request.query.find("run");
  const auto run = asked == request.query.end() ? std::nullopt : parse_number_below(asked->second, scene.num_runs());
  if (asked != request.query.end() && !run) return not_found();
  if (parts.size() == 3) return respond(kJson, scene.view(*view, run.value_or(-1)));
  if (parts.size() == 4 && parts[3] == "trace" && run) return respond(kJson, scene.trace(*view, *run));
  if (parts.size() == 4 && parts[3] == "color") return respond("image/jpeg", scene.color(*view));
  if (parts.size() == 4 && parts[3] == "depth") return respond(kBinary, scene.depth(*view));
  if (parts.size() == 4 && parts[3] == "changes" && scene.has_changes()) return respond(kBinary, scene.changes(*view));
  return not_found();
}

HttpResponse answer_data(SceneData& scene, const HttpRequest& request) {
  const auto parts = split_path(request.path);
  if (parts.size() == 2 && parts[1] == "scene") return respond(kJson, scene.index());
  if (parts.size() == 2 && parts[1] == "events") return start_events(scene);
  if (parts.size() >= 3 && parts[1] == "views") return answer_view(scene, parts, request);
  if (parts.size() == 3 && parts[1] == "surfaces") {
    const auto object = parse_number_below(parts[2], scene.num_objects());
    return object ? respond(kBinary, scene.surface(*object)) : not_found();
  }
  return not_found();
}

bool is_annotation(std::string_view path) { return path == "/api/annotation" || path.starts_with("/api/annotation/"); }

HttpResponse answer_asset(const HttpRequest& request) {
  for (const Asset& asset : viewer_assets())
    if (asset.path == request.path)
      return {200, std::string(asset.content_type), std::make_shared<const std::string>(asset.bytes)};
  return not_found();
}

}  // namespace

HttpHandler make_viewer_handler(SceneData& scene, const std::string& token, AnnotationService* annotation) {
  return [&scene, annotation, guard = std::make_shared<AccessGuard>(token)](const HttpRequest& request) {
    if (annotation != nullptr && is_annotation(request.path)) {
      if (auto refusal = guard->check_write(request)) return *std::move(refusal);
      auto parts = split_path(request.path);
      parts.erase(parts.begin(), parts.begin() + 2);
      return annotation->answer(request, parts);
    }
    const bool is_data = request.path.starts_with("/api/");
    if (auto refusal = is_data ? guard->check_data(request) : guard->check_asset(request)) return *std::move(refusal);
    return is_data ? answer_data(scene, request) : answer_asset(request);
  };
}

}  // namespace resight
