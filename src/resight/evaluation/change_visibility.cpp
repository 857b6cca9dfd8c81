// SPDX-License-Identifier: Apache-2.0
#include "resight/evaluation/change_visibility.hpp"

#include <algorithm>
#include <optional>

#include "resight/core/check.hpp"
#include "resight/evidence/surface_evidence.hpp"

namespace resight {
namespace {

// The centre of the place projects into the image, and no measured surface clearly occludes the object there.
bool looks_at(const RgbdFrame& frame, const Rigid3& world_from_object, const ObjectModel& model) {
  const Eigen::Vector3d center = world_from_object * model.center.cast<double>().eval();
  const Eigen::Vector3d p = frame.world_from_camera.inverse() * center;
  const float depth_m = nearest_depth(p.cast<float>(), {frame.camera, frame.depth_m}, 0);
  return depth_m >= p.z() - 0.5 * model.diameter_m;  // False for NaN.
}

}  // namespace

ChangeVisibilityFinder::ChangeVisibilityFinder(const ModelLibrary& library, const SequenceTruth& truth,
                                               const MatchDetectionsOptions& options)
    : library_(library), truth_(truth), options_(options) {
  require(truth.changes.has_value(), "ChangeVisibilityFinder: the truth has no changes");
  visibilities_.resize(truth.changes->size(), {-1, -1, -1, -1});
  for (const TrueChange& change : *truth.changes) limits_.push_back(find_limits(change));
}

void ChangeVisibilityFinder::add_view(const RgbdFrame& frame) {
  for (std::size_t i = 0; i < visibilities_.size(); ++i) {
    const TrueChange& change = (*truth_.changes)[i];
    const int object = library_.find(change.object);
    if (object < 0 || !change.known) continue;
    const ObjectModel& model = library_.objects[static_cast<std::size_t>(object)];
    const std::optional<Rigid3>& before = change.world_from_object_before;
    const std::optional<Rigid3>& after = change.world_from_object_after;
    const Limits& limits = limits_[i];
    ChangeVisibility& visibility = visibilities_[i];
    if (change.view > view_) {
      if (before && view_ >= limits.there_since && shows(frame, change.object, *before, model))
        visibility.last_there_view = view_;
      if (after && view_ >= limits.free_since && looks_at(frame, *after, model) &&
          !shows(frame, change.object, *after, model))
        visibility.last_free_view = view_;
      continue;
    }
    if (before && visibility.before_view < 0 && view_ < limits.free_until && looks_at(frame, *before, model) &&
        !shows(frame, change.object, *before, model))
      visibility.before_view = view_;
    if (after && visibility.after_view < 0 && view_ < limits.there_until && shows(frame, change.object, *after, model))
      visibility.after_view = view_;
  }
  ++view_;
}

ChangeVisibilityFinder::Limits ChangeVisibilityFinder::find_limits(const TrueChange& change) const {
  const int num_views = static_cast<int>(truth_.views.size());
  Limits limits{.there_since = 0, .free_since = 0, .free_until = num_views, .there_until = num_views};
  const int object = library_.find(change.object);
  if (object < 0) return limits;
  const ObjectModel& model = library_.objects[static_cast<std::size_t>(object)];
  const auto is_same_place = [&](const std::optional<Rigid3>& a, const std::optional<Rigid3>& b) {
    return a && b && is_within(compare_poses(*a, *b, model), options_);
  };
  for (const TrueChange& other : *truth_.changes) {
    if (&other == &change || other.object != change.object) continue;
    const bool comes_back = is_same_place(other.world_from_object_after, change.world_from_object_before);
    const bool leaves_new_place = is_same_place(other.world_from_object_before, change.world_from_object_after);
    if (comes_back && other.view < change.view) limits.there_since = std::max(limits.there_since, other.view);
    if (comes_back && other.view >= change.view) limits.free_until = std::min(limits.free_until, other.view);
    if (leaves_new_place && other.view <= change.view) limits.free_since = std::max(limits.free_since, other.view);
    if (leaves_new_place && other.view > change.view) limits.there_until = std::min(limits.there_until, other.view);
  }
  return limits;
}

bool ChangeVisibilityFinder::shows(const RgbdFrame& frame, const std::string& object, const Rigid3& world_from_object,
                                   const ObjectModel& model) const {
  const std::vector<GroundTruthObject>& objects = truth_.views.at(static_cast<std::size_t>(view_)).objects;
  return std::ranges::any_of(objects, [&](const GroundTruthObject& truth) {
    return truth.object == object && !(truth.visible_share < options_.min_visible_share) &&
           is_within(compare_poses(frame.world_from_camera * truth.camera_from_object, world_from_object, model),
                     options_);
  });
}

}  // namespace resight
