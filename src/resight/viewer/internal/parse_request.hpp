// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string_view>

#include "resight/viewer/http_message.hpp"
#include "resight/viewer/http_server.hpp"

namespace resight::viewer {

/// The request that the server gives to its handler if it receives these bytes; none if it refuses them, or waits for
/// more. For tests without a connection.
[[nodiscard]] std::optional<HttpRequest> parse_request(std::string_view bytes, const HttpLimits& limits = {});

}  // namespace resight::viewer
