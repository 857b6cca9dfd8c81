// SPDX-License-Identifier: Apache-2.0
#include "resight/viewer/http_server.hpp"

#include <gmock/gmock.h>

#include <chrono>
#include <csignal>
#include <stdexcept>
#include <vector>

#include "resight/viewer/http_test_client.hpp"
#include "resight/viewer/internal/parse_query.hpp"
#include "resight/viewer/internal/parse_request.hpp"

namespace resight {
namespace {

using test::body_of;
using test::RawConnection;
using test::RunningServer;
using test::status_of;
using testing::HasSubstr;

constexpr const char* kAsk = "GET /x HTTP/1.1\r\nHost: localhost\r\n\r\n";

HttpResponse echo(const HttpRequest& request) {
  if (request.path == "/events") {
    HttpResponse stream = make_text_response(200, "first");
    stream.is_event_stream = true;
    return stream;
  }
  if (request.path == "/throw") throw std::runtime_error("out of order");
  return make_text_response(200, request.method + " " + request.path + " " + request.host + " " + request.token + " " +
                                     std::to_string(request.body.size()));
}

HttpLimits small_limits() {
  HttpLimits limits;
  limits.max_header_bytes = 2000;
  limits.max_body_bytes = 1000;
  limits.max_connections = 8;
  return limits;
}

// So short that a test can wait for it, and a busy machine may exceed it.
HttpLimits hasty_limits() {
  HttpLimits limits = small_limits();
  limits.request_time_s = 0.3;
  return limits;
}

TEST(HttpServer, AnswersRequestsOnOneConnection) {
  const RunningServer server(echo);
  const RawConnection connection = server.connect();
  const std::string first = connection.ask("GET /a?b=1 HTTP/1.1\r\nHost: localhost:1\r\nX-Resight-Token: t\r\n\r\n");
  EXPECT_EQ(status_of(first), 200);
  EXPECT_EQ(body_of(first), "GET /a localhost:1 t 0");
  EXPECT_EQ(body_of(connection.ask("POST /c HTTP/1.1\r\nHost: h\r\nContent-Length: 3\r\n\r\nxyz")), "POST /c h  3");
}

TEST(HttpServer, AnInterruptBeforeItRunsIsNotLost) {
  HttpServer server = HttpServer::listen(0, echo).value();
  server.catch_interrupts();
  std::raise(SIGINT);
  server.run_until_interrupted();
  server.catch_interrupts();  // Nothing of the last time is left.
  std::raise(SIGTERM);
  server.run_until_interrupted();
}

TEST(HttpServer, ForbidsWhatThePageDoesNotNeed) {
  const RunningServer server(echo);
  const std::string answer = server.ask(kAsk);
  EXPECT_THAT(answer, HasSubstr("Content-Security-Policy: default-src 'none'; script-src 'self'"));
  EXPECT_THAT(answer, HasSubstr("Cross-Origin-Resource-Policy: same-origin"));
  EXPECT_THAT(answer, HasSubstr("X-Content-Type-Options: nosniff"));
  EXPECT_THAT(answer, testing::Not(HasSubstr("Access-Control")));
}

TEST(HttpServer, RefusesMalformedRequests) {
  const RunningServer server(echo);
  for (const std::string& request :
       {std::string("\r\n\r\n\r\n"), std::string("GET\r\n\r\n"), std::string("GET / HTTP/9.9\r\n\r\n"),
        std::string("GET / HTTP/1.1\r\nno colon\r\n\r\n"), std::string("\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03", 10),
        std::string("POST / HTTP/1.1\r\nContent-Length: -1\r\n\r\n"),
        std::string("POST / HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\nzz\r\n")})
    EXPECT_EQ(status_of(server.ask(request)), 400) << request;
  EXPECT_EQ(status_of(server.ask(kAsk)), 200);
}

TEST(HttpServer, RefusesLongHeadersAndBodies) {
  const RunningServer server(echo, small_limits());
  EXPECT_EQ(status_of(server.ask("GET / HTTP/1.1\r\nX: " + std::string(3000, 'x') + "\r\n\r\n")), 431);
  EXPECT_EQ(status_of(server.ask("GET /" + std::string(300000, 'x'))), 431);
  EXPECT_EQ(status_of(server.ask("POST / HTTP/1.1\r\nContent-Length: 99999999999\r\n\r\n")), 413);
  // The client sends all of it before it reads.
  EXPECT_EQ(status_of(server.ask("POST / HTTP/1.1\r\nContent-Length: 2000000\r\n\r\n" + std::string(2000000, 'x'))),
            413);
  EXPECT_EQ(status_of(server.ask("POST / HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\nfffff\r\n" +
                                 std::string(0xfffff, 'x'))),
            413);
  EXPECT_EQ(status_of(server.ask(kAsk)), 200);
}

TEST(HttpServer, RefusesEndlessChunksAndTrailers) {
  const RunningServer server(echo, small_limits());
  for (const std::string begin : {"5;", "0\r\n"}) {
    const RawConnection connection(server.port());
    connection.send("POST / HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\n" + begin);
    const std::string some = begin == "5;" ? std::string(1000, 'x') : "Name: " + std::string(992, 'x') + "\r\n";
    int num_sent = 0;
    while (num_sent < 60'000 && connection.send(some)) ++num_sent;
    EXPECT_LT(num_sent, 60'000) << "the server has taken 60 MB";
  }
}

TEST(HttpServer, GivesUpOnSlowClients) {
  const RunningServer server(echo, hasty_limits());
  const RawConnection connection = server.connect();
  // A byte now and then does not prolong the time of a request.
  const std::string request = kAsk;
  std::size_t num_sent = 0;
  while (num_sent < 8 && connection.send(request.substr(num_sent, 1))) {
    ++num_sent;
    std::this_thread::sleep_for(std::chrono::milliseconds(60));
  }
  EXPECT_EQ(status_of(connection.receive()), 408);
  EXPECT_EQ(server.connect().receive(), "") << "a connection that asks nothing is closed";
  EXPECT_EQ(status_of(server.ask(kAsk)), 200);
}

TEST(HttpServer, SurvivesClientsThatLeave) {
  RunningServer server(echo, hasty_limits());
  for (int i = 0; i < 50; ++i) server.connect().send("GET / HT");
  for (int i = 0; i < 50; ++i) server.connect().send(kAsk);
  int status = 0;
  for (int wait = 0; wait < 200 && status != 200; ++wait) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    status = status_of(server.ask(kAsk));
  }
  EXPECT_EQ(status, 200);
  std::this_thread::sleep_for(std::chrono::milliseconds(500));  // longer than a request may take
  server.stop();
  EXPECT_EQ(server.server().num_connections(), 0);
}

TEST(HttpServer, RefusesFurtherConnectionsWithAStatus) {
  HttpLimits limits = small_limits();
  limits.request_time_s = 30;
  const RunningServer server(echo, limits);
  std::vector<RawConnection> connections;
  for (int i = 0; i < 100; ++i) connections.push_back(server.connect());
  int num_answered = 0;
  int num_refused = 0;
  for (const RawConnection& connection : connections) {
    const int status = status_of(connection.ask(kAsk));
    num_answered += status == 200;
    num_refused += status == 503;
  }
  EXPECT_EQ(num_answered, limits.max_connections);
  EXPECT_EQ(num_refused, 100 - limits.max_connections);
  connections.clear();
  int status = 0;  // the server notices soon that they have gone
  for (int wait = 0; wait < 100 && status != 200; ++wait) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    status = status_of(server.ask(kAsk));
  }
  EXPECT_EQ(status, 200);
}

TEST(HttpServer, StreamsEventsUntilTheClientLeaves) {
  HttpLimits limits = small_limits();
  limits.heartbeat_s = 0.05;
  RunningServer server(echo, limits);
  {
    const RawConnection stream = server.connect();
    stream.send("GET /events HTTP/1.1\r\nHost: localhost\r\n\r\n");
    std::string received = stream.receive_until("data: first\n\n");
    EXPECT_EQ(status_of(received), 200);
    EXPECT_THAT(received, testing::Not(HasSubstr("Content-Length")));
    EXPECT_THAT(received, HasSubstr("Content-Security-Policy"));
    EXPECT_THAT(stream.receive_until(":\n\n"), HasSubstr(":\n\n")) << "a sign of life";
    server.send_event("second");
    EXPECT_THAT(stream.receive_until("data: second\n\n"), HasSubstr("data: second\n\n"));
    EXPECT_EQ(status_of(server.ask(kAsk)), 200) << "others are answered meanwhile";
  }
  for (int i = 0; i < 20; ++i) {
    server.send_event(std::to_string(i));
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  server.stop();
  EXPECT_LE(server.server().num_connections(), 1) << "the stream has ended; the last request may still be open";
}

TEST(HttpServer, ASlowStreamGetsTheNewestEvent) {
  RunningServer server(echo);
  const RawConnection stream = server.connect();
  stream.send("GET /events HTTP/1.1\r\nHost: localhost\r\n\r\n");
  (void)stream.receive_until("data: first\n\n");
  // Far more than the buffers of a connection hold, while the client reads nothing.
  const std::string large(1 << 20, 'x');
  for (int i = 0; i < 50; ++i) server.send_event(large + std::to_string(i));
  const std::string received = stream.receive_until("x49\n\n");
  EXPECT_TRUE(received.ends_with("x49\n\n"));
  EXPECT_LT(received.size(), 40U << 20) << "those in between are left out";
}

TEST(HttpServer, ReportsFailuresOfTheHandler) {
  const RunningServer server(echo);
  const std::string answer = server.ask("GET /throw HTTP/1.1\r\nHost: localhost\r\n\r\n");
  EXPECT_EQ(status_of(answer), 500);
  EXPECT_EQ(body_of(answer), "failed: out of order");
}

TEST(HttpServer, ListensOnLoopbackOnly) {
  const auto taken = HttpServer::listen(0, echo);
  ASSERT_TRUE(taken.ok());
  const auto second = HttpServer::listen(taken->port(), echo);
  ASSERT_FALSE(second.ok());
  EXPECT_THAT(second.error().message, HasSubstr("of 127.0.0.1: "));
}

TEST(ParseRequest, ReadsWhatTheServerReads) {
  using viewer::parse_request;
  const auto request =
      parse_request("POST /a?b=1 HTTP/1.1\r\nHost: h\r\nX-Resight-Token: t\r\nContent-Length: 3\r\n\r\nxyz");
  ASSERT_TRUE(request.has_value());
  EXPECT_EQ(request->method, "POST");
  EXPECT_EQ(request->path, "/a");
  EXPECT_EQ(request->query.at("b"), "1");
  EXPECT_EQ(request->host, "h");
  EXPECT_EQ(request->token, "t");
  EXPECT_EQ(request->body, "xyz");
  const auto chunked = parse_request("POST / HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\n2\r\n{}\r\n0\r\n\r\n");
  ASSERT_TRUE(chunked.has_value());
  EXPECT_EQ(chunked->body, "{}");
  for (const char* bytes : {"", "GET", "GET / HTTP/9.9\r\n\r\n", "POST / HTTP/1.1\r\nContent-Length: 3\r\n\r\nxy",
                            "POST / HTTP/1.1\r\nContent-Length: 99999999999\r\n\r\n", "\r\n\r\n\r\n"})
    EXPECT_FALSE(parse_request(bytes).has_value()) << bytes;
  EXPECT_FALSE(parse_request("GET / HTTP/1.1\r\nX: " + std::string(9000, 'x') + "\r\n\r\n").has_value());
}

TEST(SplitTarget, SeparatesPathAndQuery) {
  std::string path;
  std::map<std::string, std::string> query;
  split_target("/a/b?x=1&y&x=2&=3", path, query);
  EXPECT_EQ(path, "/a/b");
  EXPECT_EQ(query, (std::map<std::string, std::string>{{"x", "1"}, {"y", ""}, {"", "3"}}));
}

}  // namespace
}  // namespace resight
