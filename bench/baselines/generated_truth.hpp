// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "resight/simulation/simulation.hpp"
#include "stage_input.hpp"

namespace resight::bench {

/// Ground truth of view number `view` of the generated scene; changes are relative to view number `other`.
[[nodiscard]] ViewTruth truth_of_view(const Simulation& simulation, const SimulatedView& rendered, int view, int other);

}  // namespace resight::bench
