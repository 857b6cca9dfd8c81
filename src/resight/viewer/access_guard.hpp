// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <optional>
#include <string>
#include <string_view>

#include "resight/viewer/http_message.hpp"

namespace resight {

/// A secret of 128 random bits as 32 hexadecimal digits.
[[nodiscard]] std::string make_access_token();

/// Compares without telling by its time how much of the secret is right.
[[nodiscard]] bool is_same_secret(std::string_view a, std::string_view b);

/// Whether a Host header names this machine by a loopback name: localhost, 127.0.0.1 or [::1], with any port. Other
/// names that lead to 127.0.0.1 are pages of strangers that use the browser of the user (DNS rebinding).
[[nodiscard]] bool is_loopback_host(std::string_view host);

/// Decides which requests are answered.
class AccessGuard {
 public:
  explicit AccessGuard(std::string token) : token_(std::move(token)) {}
  /// The refusal of a request for assets, or none.
  [[nodiscard]] std::optional<HttpResponse> check_asset(const HttpRequest& request) const;
  /// The refusal of a request for data, which needs the token, or none. After 20 wrong tokens within a second, further
  /// wrong ones get status 429.
  [[nodiscard]] std::optional<HttpResponse> check_data(const HttpRequest& request);
  /// Same, where POST is answered, too.
  [[nodiscard]] std::optional<HttpResponse> check_write(const HttpRequest& request);

 private:
  [[nodiscard]] std::optional<HttpResponse> check_token(const HttpRequest& request);
  std::string token_;
  std::chrono::steady_clock::time_point count_since_;
  int num_wrong_ = 0;  ///< Wrong tokens since then.
};

}  // namespace resight
