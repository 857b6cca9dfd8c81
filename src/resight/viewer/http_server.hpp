// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <memory>
#include <string>

#include "resight/core/result.hpp"
#include "resight/viewer/http_message.hpp"

namespace resight {

/// What one client can take of the server.
struct HttpLimits {
  std::uint32_t max_header_bytes = 8 << 10;  ///< Beyond: status 431.
  std::uint64_t max_body_bytes = 1 << 20;    ///< Beyond: status 413. Leaves room for masks.
  int max_connections = 64;                  ///< Beyond: status 503.
  double request_time_s = 15;   ///< For a request to arrive, from the end of the last one. Beyond: status 408.
  double response_time_s = 60;  ///< For an answer to be taken. Beyond: the connection is closed.
  double heartbeat_s = 15;      ///< A stream of events without any gets a sign of life, which tells whether it is open.
};

/// An HTTP/1.1 server on 127.0.0.1. All requests are answered in turn by one thread, the one that calls run().
class HttpServer {
 public:
  /// Listens on `port`; 0 takes a free one. Fails if the port is taken.
  [[nodiscard]] static Result<HttpServer> listen(std::uint16_t port, HttpHandler handler,
                                                 const HttpLimits& limits = {});
  HttpServer(HttpServer&& other) noexcept;
  HttpServer& operator=(HttpServer&& other) noexcept;
  ~HttpServer();

  [[nodiscard]] std::uint16_t port() const;
  /// Number of open connections. To be called while run() does not run, or by the handler.
  [[nodiscard]] int num_connections() const;

  /// Answers requests until stop() is called. May be called again afterwards; open connections persist.
  void run();
  /// From now on, SIGINT and SIGTERM only end run_until_interrupted(), also if they come before it is called.
  void catch_interrupts();
  /// Answers requests until the process gets SIGINT or SIGTERM.
  void run_until_interrupted();
  /// May be called from any thread.
  void stop();
  /// Sends an event to all streams (HttpResponse::is_event_stream). A client that has not taken the last event yet gets
  /// only the newest one afterwards. `data` has one line. May be called from any thread.
  void send_event(const std::string& data);

 private:
  class Impl;
  explicit HttpServer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace resight
