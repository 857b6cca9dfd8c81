// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "resight/sensor/rgbd_frame.hpp"
#include "resight/viewer/internal/sequence_numbers.hpp"
#include "resight/viewer/object_table.hpp"

namespace resight::viewer {

/// Per run and view of the sequence: its number in the results, or -1.
using StoredViewNumbers = std::vector<std::vector<int>>;

/// Everything but images, clouds and details of detections. Poses are 4x4 matrices, column by column.
[[nodiscard]] std::string format_index(const ViewerScene& scene, const ObjectTable& objects,
                                       const StoredViewNumbers& stored_views, int revision);

/// A view with the outlines and details of its detections and of its ground truth. `stored`: null without results.
/// `numbers`: of the views of the run.
[[nodiscard]] std::string format_view(const ViewerScene& scene, const ObjectTable& objects, const RgbdFrame& frame,
                                      const StoredView* stored, const SequenceNumbers& numbers,
                                      const std::vector<GroundTruthObject>& truth);

}  // namespace resight::viewer
