// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "resight/annotation/annotation_document.hpp"
#include "resight/models/object_model.hpp"

namespace resight {

/// A change of a thing, with or without model, that happened before `view` was recorded.
struct AnnotatedEvent {
  int view = 0;
  AnnotatedEventKind kind = AnnotatedEventKind::kAdded;
  int track = -1;   ///< -1: a thing without model.
  int object = -1;  ///< Index into the library; -1: a thing without model.
  std::string name;
  std::optional<Rigid3> world_from_object_before;  ///< Absent for kAdded. Without model: the place of the centre.
  std::optional<Rigid3> world_from_object_after;   ///< Absent for kRemoved.
};

/// The placements of a track in the order of time.
[[nodiscard]] std::vector<AnnotatedObject> placements_of_track(const AnnotationDocument& document, int track);

/// Same of all tracks, by their numbers.
[[nodiscard]] std::map<int, std::vector<AnnotatedObject>> placements_by_track(const AnnotationDocument& document);

/// All changes, in order of view and track. Those of known objects follow from their placements: a track that begins
/// after the first view was added, one that ends before the last view was removed, and one that goes on elsewhere in
/// the next view was moved. After a gap it was removed and added.
[[nodiscard]] std::vector<AnnotatedEvent> derive_events(const AnnotationDocument& document, const ModelLibrary& library,
                                                        int num_views);

}  // namespace resight
