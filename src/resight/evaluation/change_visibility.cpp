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
  for (const TrueChange& change : *truth.changes) stands_since_.push_back(find_arrival_before(change));
}

void ChangeVisibilityFinder::add_view(const RgbdFrame& frame) {
  for (std::size_t i = 0; i < visibilities_.size(); ++i) {
    const TrueChange& change = (*truth_.changes)[i];
    const int object = library_.find(change.object);
    if (object < 0 || !change.known) continue;
    const ObjectModel& model = library_.objects[static_cast<std::size_t>(object)];
    const std::optional<Rigid3>& before = change.world_from_object_before;
    const std::optional<Rigid3>& after = change.world_from_object_after;
    ChangeVisibility& visibility = visibilities_[i];
    if (change.view > view_) {
      if (before && view_ >= stands_since_[i] && shows(frame, change.object, *before, model))
        visibility.last_there_view = view_;
      if (after && looks_at(frame, *after, model) && !shows(frame, change.object, *after, model))
        visibility.last_free_view = view_;
      continue;
    }
    if (before && visibility.before_view < 0 && looks_at(frame, *before, model) &&
        !shows(frame, change.object, *before, model))
      visibility.before_view = view_;
    if (after && visibility.after_view < 0 && shows(frame, change.object, *after, model)) visibility.after_view = view_;
  }
  ++view_;
}

// View of the last change that brought the object to the place it leaves; 0 if it was there from the first view on.
int ChangeVisibilityFinder::find_arrival_before(const TrueChange& change) const {
  const int object = library_.find(change.object);
  if (object < 0 || !change.world_from_object_before) return 0;
  const ObjectModel& model = library_.objects[static_cast<std::size_t>(object)];
  int since = 0;
  for (const TrueChange& other : *truth_.changes)
    if (other.object == change.object && other.view < change.view && other.world_from_object_after &&
        is_within(compare_poses(*other.world_from_object_after, *change.world_from_object_before, model), options_))
      since = std::max(since, other.view);
  return since;
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
