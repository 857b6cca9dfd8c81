// SPDX-License-Identifier: Apache-2.0
#include "viewer_session.hpp"

#include <fmt/format.h>

#include <stdexcept>

#include "commands.hpp"
#include "resight/viewer/access_guard.hpp"
#include "resight/viewer/viewer_routes.hpp"
#include "terminal.hpp"

namespace resight::app {

ViewerSession::ViewerSession(const ViewerSessionOptions& options)
    : no_open_(options.no_open),
      token_(make_access_token()),
      handler_(std::make_shared<HttpHandler>()),
      server_(value_or_throw(HttpServer::listen(
          options.port, [handler = handler_](const HttpRequest& request) { return (*handler)(request); }))) {}

void ViewerSession::show(SceneData& scene, AnnotationService* annotation) {
  *handler_ = make_viewer_handler(scene, token_, annotation);
}

void ViewerSession::open() {
  const std::string address = fmt::format("http://127.0.0.1:{}/#token={}", server_.port(), token_);
  print("{}\n(for this user only; Ctrl-C ends it)\n", address);
  // A program that waits for the address may read it through a pipe. Without the address nobody can see the page.
  if (!finish_output() && no_open_)
    throw std::runtime_error("the address could not be written to the terminal, pipe or file");
  if (!no_open_) browser_.emplace(address);
}

void ViewerSession::open_until_interrupted() {
  server_.catch_interrupts();  // Before the address is out, because whoever reads it may interrupt at once.
  open();
  server_.run_until_interrupted();
}

}  // namespace resight::app
