// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <variant>

#include "resight/annotation/pixel_runs.hpp"
#include "resight/annotation/region_key.hpp"
#include "resight/core/result.hpp"
#include "resight/geometry/rigid3.hpp"

namespace resight {

/// An object at one place, from the view in which it came to the last view before it left.
struct AnnotatedObject {
  int id = -1;      ///< Number of the placement; never used again. -1: the document gives it the next one.
  int track = -1;   ///< Number of the thing, which keeps it when it moves. -1: the next one.
  int object = -1;  ///< Index into the model library.
  int first_view = 0;
  int last_view = 0;  ///< Inclusive.
  Rigid3 world_from_object;

  [[nodiscard]] bool is_in(int view) const { return first_view <= view && view <= last_view; }
};

/// What the user says of a region that the change detector proposes.
enum class RegionVerdict { kOpen, kAccepted, kRejected };

struct RegionJudgement {
  RegionKey region;
  RegionVerdict verdict = RegionVerdict::kOpen;
  int track = -1;                 ///< The thing that came or left; -1: none of the known ones.
  std::optional<PixelRuns> mask;  ///< As corrected by hand, in the recorded image of its view; none: as proposed.
};

enum class AnnotatedEventKind { kAdded, kMoved, kRemoved };

/// A change of a thing that has no model. Happens before its view was recorded.
struct UnknownObjectEvent {
  int id = -1;  ///< -1: the document gives it the next one.
  int view = 0;
  AnnotatedEventKind kind = AnnotatedEventKind::kAdded;
  std::string name;
  std::optional<Eigen::Vector3d> before_in_world_m;  ///< Centre; absent for kAdded.
  std::optional<Eigen::Vector3d> after_in_world_m;   ///< Centre; absent for kRemoved.
};

/// What can be annotated: bounds of all numbers.
struct AnnotationLimits {
  int num_views = 0;
  int num_objects = 0;
};

/// All that has been annotated.
struct AnnotationDocument {
  std::map<int, AnnotatedObject> objects;        ///< By id.
  std::map<RegionKey, RegionJudgement> regions;  ///< Those that somebody has decided about or corrected.
  std::map<int, UnknownObjectEvent> unknown_events;
  std::set<int> checked_views;
  int next_id = 0;
  int next_track = 0;
};

// Changes of a document.
struct PutObject {
  AnnotatedObject object;  ///< Replaces the placement of the same id.
};
struct DropObject {
  int id = -1;
};
struct JudgeRegion {
  RegionJudgement judgement;
  bool keeps_mask = false;  ///< The mask stays what it is, whatever the judgement says.
};
struct CheckView {
  int view = 0;
  bool is_checked = true;
};
struct PutUnknownEvent {
  UnknownObjectEvent event;
};
struct DropUnknownEvent {
  int id = -1;
};
using AnnotationChange = std::variant<PutObject, DropObject, JudgeRegion, CheckView, PutUnknownEvent, DropUnknownEvent>;

/// Applies a change and returns the one that undoes it. Numbers of -1 become the next free ones, and a mask that
/// is kept is filled in, also in `change`, so that it has the same effect when it is applied again. A region that is
/// open and not corrected is forgotten. Fails, and changes nothing, for numbers beyond the limits, placements that end
/// before they begin, poses that are not rigid or far away, masks that check_runs() refuses, and what is to be dropped
/// but not there.
[[nodiscard]] Result<AnnotationChange> apply_change(AnnotationDocument& document, AnnotationChange& change,
                                                    const AnnotationLimits& limits);

}  // namespace resight
