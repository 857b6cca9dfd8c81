// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "resight/changes/removal_support.hpp"
#include "resight/history/place_change.hpp"
#include "resight/hypotheses/hypothesis.hpp"
#include "resight/models/object_model.hpp"
#include "resight/reconstruction/dynamic_scene.hpp"

namespace resight {

/// The changes that one view of the window found.
struct ViewChanges {
  int view = 0;  ///< Number of the view in the sequence.
  const PointCloud* removed_in_world = nullptr;
  const PointCloud* novel_in_world = nullptr;
};

/// In which views of the window (ascending, the current one last) each hypothesis may be present: views x hypotheses,
/// view-major, 1 = may be present. Paper Sec. III-A: "only checks nearby points for test views where the object is
/// indicated as present".
///
/// Each view may hold two events for the place of a hypothesis: removed points on its surface (absent from then on,
/// unless the view or a later one generated the hypothesis again) and novel points on its surface (present from then
/// on, absent before). If a view holds both, the object is present: one that is pushed a little uncovers a strip and
/// covers another. The last event up to a view decides; before all events, the first one does.
[[nodiscard]] std::vector<std::uint8_t> compute_presence_mask(std::span<const Hypothesis> hypotheses,
                                                              const ModelLibrary& library,
                                                              std::span<const ViewChanges> window,
                                                              const RemovalSupportOptions& options = {},
                                                              int num_threads = 1);

/// Of each hypothesis, whether a view after those that generated it shows a change at its place: its object is perhaps
/// no longer there, or no longer exactly there.
[[nodiscard]] std::vector<std::uint8_t> find_outdated(std::span<const Hypothesis> hypotheses,
                                                      const ModelLibrary& library, std::span<const ViewChanges> window,
                                                      const RemovalSupportOptions& options, int num_threads);

/// Drops the correspondences of outdated hypotheses: they would hold the pose of an object that was pushed. Does
/// nothing without flags.
void drop_correspondences(std::span<Hypothesis> hypotheses, std::span<const std::uint8_t> outdated);

/// The changes of the views of a scene, which must outlive them.
[[nodiscard]] std::vector<ViewChanges> changes_of(const std::deque<DynamicScene::View>& window);

/// Finds the last change of the window at the place of an object. The arguments must outlive it.
[[nodiscard]] FindPlaceChange make_find_change(const ModelLibrary& library, std::span<const ViewChanges> window,
                                               const RemovalSupportOptions& options);

/// Drops the hypotheses that the mask excludes from the current view, from both. Does nothing if the mask is empty.
void discard_absent(std::vector<Hypothesis>& hypotheses, std::vector<std::uint8_t>& mask);

}  // namespace resight
