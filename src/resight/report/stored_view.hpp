// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "resight/io/recognition_results.hpp"
#include "resight/report/view_record.hpp"

namespace resight {

/// A view as its results files will hold it, for the viewer while a run goes on.
[[nodiscard]] StoredView to_stored_view(const ViewRecord& view, const ModelLibrary& library);

/// The events of a view as the results files will hold them.
[[nodiscard]] std::vector<StoredEvent> to_stored_events(const ViewRecord& view, const ModelLibrary& library);

}  // namespace resight
