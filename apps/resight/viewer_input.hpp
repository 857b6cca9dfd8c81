// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "commands.hpp"
#include "resight/viewer/viewer_scene.hpp"

namespace resight::app {

/// Opens what `resight view` was asked to show: results of `resight recognize`, a sequence, a model library or models.
/// Of results, also the sequence and the library that they name, unless the arguments name others.
[[nodiscard]] ViewerScene open_viewer_scene(const ViewArguments& arguments);

}  // namespace resight::app
