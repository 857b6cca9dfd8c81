// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/beast/http.hpp>

#include "resight/viewer/http_message.hpp"
#include "resight/viewer/http_server.hpp"

namespace resight::viewer {

using HttpParser = boost::beast::http::request_parser<boost::beast::http::string_body>;

void set_limits(const HttpLimits& limits, HttpParser& parser);

/// What the viewer needs of a request that has been parsed.
[[nodiscard]] HttpRequest to_request(const HttpParser::value_type& message);

}  // namespace resight::viewer
