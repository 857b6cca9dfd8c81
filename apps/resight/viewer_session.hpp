// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "browser.hpp"
#include "resight/viewer/annotation_service.hpp"
#include "resight/viewer/http_server.hpp"
#include "resight/viewer/scene_data.hpp"

namespace resight::app {

struct ViewerSessionOptions {
  std::uint16_t port = 0;  ///< 0: a free one.
  bool no_open = false;    ///< Do not open a browser.
};

/// A server of one scene under a secret address.
class ViewerSession {
 public:
  /// Throws an InputError if the port is taken.
  explicit ViewerSession(const ViewerSessionOptions& options);
  ViewerSession(SceneData& scene, const ViewerSessionOptions& options) : ViewerSession(options) { show(scene); }
  /// What the session shows; to be called before open(). Both must be there as long as requests are answered.
  void show(SceneData& scene, AnnotationService* annotation = nullptr);
  /// Prints the address, and opens it in the browser. Throws if it cannot be printed.
  void open();
  /// Same, and answers requests until the process gets SIGINT or SIGTERM.
  void open_until_interrupted();
  [[nodiscard]] HttpServer& server() { return server_; }

 private:
  bool no_open_;
  std::string token_;
  std::shared_ptr<HttpHandler> handler_;  ///< The server, which can be moved, has it as well.
  HttpServer server_;
  std::optional<BrowserLaunch> browser_;
};

}  // namespace resight::app
