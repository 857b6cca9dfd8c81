// SPDX-License-Identifier: Apache-2.0
#include "viewer_session.hpp"

#include <fmt/format.h>

#include <cstdio>

#include "resight/viewer/access_guard.hpp"
#include "resight/viewer/viewer_routes.hpp"

namespace resight::app {

ViewerSession::ViewerSession(SceneData& scene, const ViewerSessionOptions& options, AnnotationService* annotation)
    : token_(make_access_token()),
      server_(value_or_throw(HttpServer::listen(options.port, make_viewer_handler(scene, token_, annotation)))) {
  const std::string address = fmt::format("http://127.0.0.1:{}/#token={}", server_.port(), token_);
  print("{}\n(for this user only; Ctrl-C ends it)\n", address);
  std::fflush(stdout);  // a program that waits for the address may read it through a pipe
  if (!options.no_open) browser_.emplace(address);
}

}  // namespace resight::app
