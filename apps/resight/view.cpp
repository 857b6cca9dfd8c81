// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cstdio>
#include <optional>

#include "browser.hpp"
#include "commands.hpp"
#include "resight/viewer/access_guard.hpp"
#include "resight/viewer/http_server.hpp"
#include "resight/viewer/viewer_routes.hpp"
#include "viewer_input.hpp"

namespace resight::app {

void run_view(const ViewArguments& arguments) {
  const auto scene = value_or_throw(SceneData::create(open_viewer_scene(arguments)));
  const std::string token = make_access_token();
  HttpServer server = value_or_throw(HttpServer::listen(arguments.port, make_viewer_handler(*scene, token)));
  const std::string address = fmt::format("http://127.0.0.1:{}/#token={}", server.port(), token);
  print("{}\n(for this user only; Ctrl-C ends it)\n", address);
  std::fflush(stdout);  // a program that waits for the address may read it through a pipe
  std::optional<BrowserLaunch> browser;
  if (!arguments.no_open) browser.emplace(address);
  server.run_until_interrupted();
}

}  // namespace resight::app
