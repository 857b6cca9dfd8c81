// SPDX-License-Identifier: Apache-2.0
#include "resight/viewer/access_guard.hpp"

#include <gtest/gtest.h>

#include <set>

namespace resight {
namespace {

HttpRequest make_request(const std::string& host, const std::string& token, const std::string& method = "GET") {
  HttpRequest request;
  request.method = method;
  request.path = "/api/scene";
  request.host = host;
  request.token = token;
  return request;
}

int status(const std::optional<HttpResponse>& refusal) { return refusal ? refusal->status : 200; }

TEST(AccessToken, IsLongAndNew) {
  std::set<std::string> tokens;
  for (int i = 0; i < 100; ++i) tokens.insert(make_access_token());
  EXPECT_EQ(tokens.size(), 100U);
  for (const std::string& token : tokens) {
    EXPECT_EQ(token.size(), 32U);
    EXPECT_EQ(token.find_first_not_of("0123456789abcdef"), token.npos);
  }
}

TEST(AccessToken, ComparesWholly) {
  EXPECT_TRUE(is_same_secret("abc", "abc"));
  for (const char* other : {"", "ab", "abd", "bbc", "abcd", "ABC"}) EXPECT_FALSE(is_same_secret("abc", other));
}

TEST(IsLoopbackHost, AcceptsLoopbackNamesOnly) {
  for (const char* host : {"localhost", "localhost:8080", "127.0.0.1", "127.0.0.1:1", "[::1]", "[::1]:65535"})
    EXPECT_TRUE(is_loopback_host(host)) << host;
  for (const char* host : {"", "evil.example", "evil.example:80", "localhost.evil.example", "127.0.0.1.evil.example",
                           "localhost:", "localhost:80x", "localhost:123456", "127.0.0.2", "::1", "0.0.0.0", "[::1]x"})
    EXPECT_FALSE(is_loopback_host(host)) << host;
}

TEST(AccessGuard, NeedsHostMethodAndToken) {
  AccessGuard guard("secret");
  EXPECT_EQ(status(guard.check_data(make_request("localhost", "secret"))), 200);
  EXPECT_EQ(status(guard.check_data(make_request("localhost", "Secret"))), 403);
  EXPECT_EQ(status(guard.check_data(make_request("localhost", ""))), 403);
  EXPECT_EQ(status(guard.check_data(make_request("evil.example", "secret"))), 403);
  EXPECT_EQ(status(guard.check_data(make_request("localhost", "secret", "POST"))), 405);
  EXPECT_EQ(status(guard.check_asset(make_request("localhost", ""))), 200);
  EXPECT_EQ(status(guard.check_asset(make_request("evil.example", ""))), 403);
  EXPECT_EQ(status(guard.check_asset(make_request("localhost", "", "DELETE"))), 405);
}

TEST(AccessGuard, SlowsDownGuessing) {
  AccessGuard guard("secret");
  int last = 0;
  for (int i = 0; i < 30; ++i) last = status(guard.check_data(make_request("localhost", "guess")));
  EXPECT_EQ(last, 429);
  EXPECT_EQ(status(guard.check_data(make_request("localhost", "secret"))), 200) << "the user is not locked out";
}

}  // namespace
}  // namespace resight
