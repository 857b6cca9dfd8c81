// SPDX-License-Identifier: Apache-2.0
#include "resight/viewer/access_guard.hpp"

#include <algorithm>
#include <cstdint>
#include <random>

namespace resight {
namespace {

constexpr int kMaxWrongTokens = 20;  // per second

bool is_port(std::string_view text) {
  return text.empty() || (text.front() == ':' && text.size() > 1 && text.size() <= 6 &&
                          std::ranges::all_of(text.substr(1), [](char c) { return c >= '0' && c <= '9'; }));
}

std::optional<HttpResponse> check_host(const HttpRequest& request) {
  if (is_loopback_host(request.host)) return std::nullopt;
  return make_text_response(403, "only localhost and 127.0.0.1 are served");
}

}  // namespace

std::string make_access_token() {
  static constexpr char kDigits[] = "0123456789abcdef";
  std::random_device source;  // of the kernel, not seeded
  std::string token;
  for (int word = 0; word < 4; ++word)
    for (std::uint32_t bits = source(), i = 0; i < 8; ++i, bits >>= 4) token += kDigits[bits & 15];
  return token;
}

bool is_same_secret(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i) difference |= static_cast<unsigned char>(a[i] ^ b[i]);
  return difference == 0;
}

bool is_loopback_host(std::string_view host) {
  return std::ranges::any_of(
      std::initializer_list<std::string_view>{"localhost", "127.0.0.1", "[::1]"},
      [&](std::string_view name) { return host.starts_with(name) && is_port(host.substr(name.size())); });
}

std::optional<HttpResponse> AccessGuard::check_asset(const HttpRequest& request) const {
  if (auto refusal = check_host(request)) return refusal;
  if (request.method != "GET") return make_text_response(405, "only GET is answered");
  return std::nullopt;
}

std::optional<HttpResponse> AccessGuard::check_data(const HttpRequest& request) {
  if (auto refusal = check_asset(request)) return refusal;
  return check_token(request);
}

std::optional<HttpResponse> AccessGuard::check_write(const HttpRequest& request) {
  if (auto refusal = check_host(request)) return refusal;
  if (request.method != "GET" && request.method != "POST") {
    auto refusal = make_text_response(405, "only GET and POST are answered");
    refusal.allowed_methods = "GET, POST";
    return refusal;
  }
  return check_token(request);
}

std::optional<HttpResponse> AccessGuard::check_token(const HttpRequest& request) {
  if (is_same_secret(request.token, token_)) return std::nullopt;
  const auto now = std::chrono::steady_clock::now();
  if (now - count_since_ > std::chrono::seconds(1)) {
    count_since_ = now;
    num_wrong_ = 0;
  }
  if (++num_wrong_ > kMaxWrongTokens) return make_text_response(429, "too many wrong tokens");
  return make_text_response(403, "the token is missing or wrong: open the address that resight printed");
}

}  // namespace resight
