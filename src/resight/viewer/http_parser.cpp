// SPDX-License-Identifier: Apache-2.0
#include "resight/viewer/internal/http_parser.hpp"

#include <boost/asio/buffer.hpp>

#include "resight/viewer/internal/parse_query.hpp"
#include "resight/viewer/internal/parse_request.hpp"

namespace resight::viewer {

void set_limits(const HttpLimits& limits, HttpParser& parser) {
  parser.header_limit(limits.max_header_bytes);
  parser.body_limit(limits.max_body_bytes);
}

HttpRequest to_request(const HttpParser::value_type& message) {
  HttpRequest request;
  request.method = std::string(message.method_string());
  const auto target = message.target();
  split_target({target.data(), target.size()}, request.path, request.query);
  request.host = std::string(message[boost::beast::http::field::host]);
  request.token = std::string(message["X-Resight-Token"]);
  request.body = message.body();
  return request;
}

std::optional<HttpRequest> parse_request(std::string_view bytes, const HttpLimits& limits) {
  HttpParser parser;
  set_limits(limits, parser);
  parser.eager(true);  // the body as well
  boost::system::error_code error;
  while (!parser.is_done()) {
    const std::size_t num_taken = parser.put(boost::asio::buffer(bytes.data(), bytes.size()), error);
    if (error || num_taken == 0) return std::nullopt;
    bytes.remove_prefix(num_taken);
  }
  return to_request(parser.get());
}

}  // namespace resight::viewer
