// SPDX-License-Identifier: Apache-2.0
#include "commands.hpp"
#include "viewer_input.hpp"
#include "viewer_session.hpp"

namespace resight::app {

void run_view(const ViewArguments& arguments) {
  const auto scene = value_or_throw(SceneData::create(open_viewer_scene(arguments)));
  ViewerSession session(*scene, {.port = arguments.port, .no_open = arguments.no_open});
  session.open_until_interrupted();
}

}  // namespace resight::app
