// SPDX-License-Identifier: Apache-2.0
#include "resight/annotation/annotation_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "resight/annotation/annotated_events.hpp"
#include "resight/annotation/matched_regions.hpp"
#include "resight/models/pose_distance.hpp"

namespace resight {
namespace {

using ToDoKind = AnnotationToDo::Kind;

constexpr float kNearSurface_m = 0.02F;
constexpr double kMinExplainedShare = 0.5;
constexpr std::size_t kMaxSurfacePoints = 1500;

AnnotationToDo make_to_do(ToDoKind kind, int view, int track, int region, std::string text) {
  return {.kind = kind, .view = view, .track = track, .region = region, .text = std::move(text), .lost = std::nullopt};
}

const char* what_it_did(RegionKind kind) { return kind == RegionKind::kNovel ? "came" : "left"; }

const char* what_was_said(RegionVerdict verdict) {
  switch (verdict) {
    case RegionVerdict::kAccepted:
      return "accepted";
    case RegionVerdict::kRejected:
      return "rejected";
    case RegionVerdict::kOpen:
      break;
  }
  return "corrected the mask of what shows";
}

const ObjectModel& model_of(const ModelLibrary& library, const AnnotatedObject& object) {
  return library.objects[static_cast<std::size_t>(object.object)];
}

/// Share of the region's points that lie near the surface of a placement.
double explained_share_of(const ChangeProposal& region, const ObjectModel& model, const Rigid3& world_from_object) {
  const Rigid3f to_object(world_from_object.inverse());
  const float reach_m = 0.5F * model.diameter_m + kNearSurface_m;
  const std::size_t step = 1 + model.surface.size() / kMaxSurfacePoints;
  int num_near = 0;
  for (const Eigen::Vector3f& in_world : region.points_in_world) {
    const Eigen::Vector3f p = to_object * in_world;
    if ((p - model.center).norm() > 2 * reach_m) continue;
    for (std::size_t i = 0; i < model.surface.size(); i += step) {
      if ((model.surface.points[i] - p).squaredNorm() > kNearSurface_m * kNearSurface_m) continue;
      ++num_near;
      break;
    }
  }
  return region.points_in_world.empty() ? 0 : num_near / static_cast<double>(region.points_in_world.size());
}

void check_track(const std::vector<AnnotatedObject>& placements, const ModelLibrary& library,
                 std::vector<AnnotationToDo>& to_dos) {
  for (std::size_t i = 1; i < placements.size(); ++i) {
    const AnnotatedObject& previous = placements[i - 1];
    const AnnotatedObject& next = placements[i];
    const std::string& name = model_of(library, next).name;
    if (next.first_view <= previous.last_view)
      to_dos.push_back(make_to_do(ToDoKind::kTwoPlaces, next.first_view, next.track, -1,
                                  fmt::format("{} is at two places in view {}", name, next.first_view + 1)));
    else if (next.first_view > previous.last_view + 1)
      to_dos.push_back(
          make_to_do(ToDoKind::kGap, previous.last_view + 1, next.track, -1,
                     fmt::format("{} is nowhere in views {} to {}", name, previous.last_view + 2, next.first_view)));
  }
}

/// Each placement is compared with earlier ones near it until one is at its place, so that many of them, at one place
/// or at many, take no time.
void check_same_places(const AnnotationDocument& document, const ModelLibrary& library,
                       std::vector<AnnotationToDo>& to_dos) {
  std::multimap<std::pair<int, double>, const AnnotatedObject*> earlier;  // By model and x of the centre.
  for (const auto& [id, object] : document.objects) {
    const ObjectModel& model = model_of(library, object);
    const double reach_m = 0.25 * model.diameter_m;
    const double x_m = (object.world_from_object * model.center.cast<double>()).x();
    const auto end = earlier.upper_bound({object.object, x_m + reach_m});
    for (auto it = earlier.lower_bound({object.object, x_m - reach_m}); it != end; ++it) {
      const AnnotatedObject& other = *it->second;
      const int view = std::max(object.first_view, other.first_view);
      if (object.track == other.track || view > std::min(object.last_view, other.last_view) ||
          center_distance_m(model, object.world_from_object, other.world_from_object) > reach_m)
        continue;
      to_dos.push_back(make_to_do(ToDoKind::kSamePlace, view, object.track, -1,
                                  fmt::format("{} is there twice in view {}", model.name, view + 1)));
      break;
    }
    earlier.emplace(std::pair(object.object, x_m), &object);
  }
}

}  // namespace

bool is_region_explained(const AnnotationDocument& document, const ModelLibrary& library,
                         const ChangeProposal& region) {
  return std::ranges::any_of(document.objects, [&](const auto& entry) {
    const AnnotatedObject& object = entry.second;
    const bool is_in_time = region.kind == RegionKind::kNovel
                                ? object.first_view > 0 && object.first_view <= region.view
                                : object.last_view < region.view;
    return is_in_time &&
           explained_share_of(region, model_of(library, object), object.world_from_object) >= kMinExplainedShare;
  });
}

std::vector<AnnotationToDo> find_to_dos(const AnnotationDocument& document, const ModelLibrary& library,
                                        std::span<const ChangeProposal> regions) {
  std::vector<AnnotationToDo> to_dos;
  for (const auto& [track, placements] : placements_by_track(document)) check_track(placements, library, to_dos);
  check_same_places(document, library, to_dos);
  std::ranges::stable_sort(to_dos, {}, &AnnotationToDo::view);
  const MatchedRegions matched = match_regions(document, regions);
  for (std::size_t r = 0; r < regions.size(); ++r) {
    const RegionJudgement* judgement = matched.of_proposal[r];
    if (judgement != nullptr && judgement->verdict != RegionVerdict::kOpen) continue;
    if (is_region_explained(document, library, regions[r])) continue;
    to_dos.push_back(
        make_to_do(ToDoKind::kUnexplained, regions[r].view, -1, static_cast<int>(r),
                   fmt::format("view {}: something {}", regions[r].view + 1, what_it_did(regions[r].kind))));
  }
  for (const RegionJudgement* judgement : matched.unmatched) {
    const RegionKey& region = judgement->region;
    to_dos.push_back(
        make_to_do(ToDoKind::kLostRegion, region.view, judgement->track, -1,
                   fmt::format("view {}: you {} that something {}, but this is no longer proposed", region.view + 1,
                               what_was_said(judgement->verdict), what_it_did(region.kind))));
    to_dos.back().lost = region;
  }
  return to_dos;
}

}  // namespace resight
