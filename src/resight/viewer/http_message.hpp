// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <map>
#include <memory>
#include <string>

namespace resight {

/// A request as far as the viewer needs it.
struct HttpRequest {
  std::string method;  ///< "GET", "POST", ...
  std::string path;    ///< As sent, without the query. Not decoded: no path of ours needs it.
  std::map<std::string, std::string> query;
  std::string host;   ///< Header Host.
  std::string token;  ///< Header X-Resight-Token.
  std::string body;
};

/// Status and content of an answer. The body is shared, so that cached content is sent without a copy.
struct HttpResponse {
  int status = 200;
  std::string content_type = "text/plain; charset=utf-8";
  std::shared_ptr<const std::string> body;
  std::string allowed_methods = "GET";  ///< Sent with status 405.
  /// The connection stays open for server-sent events: `body` is the first one, HttpServer::send_event() sends more.
  bool is_event_stream = false;
};

/// A short text with a status.
[[nodiscard]] inline HttpResponse make_text_response(int status, std::string text) {
  return {status, "text/plain; charset=utf-8", std::make_shared<const std::string>(std::move(text)), "GET"};
}

/// Answers a request. Exceptions become status 500.
using HttpHandler = std::function<HttpResponse(const HttpRequest&)>;

}  // namespace resight
