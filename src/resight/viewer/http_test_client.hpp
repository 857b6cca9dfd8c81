// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <thread>
#include <utility>

#include "resight/viewer/http_server.hpp"

namespace resight::test {

/// A connection that sends any bytes, valid requests or not.
class RawConnection {
 public:
  explicit RawConnection(std::uint16_t port) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    is_open_ = ::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;
  }
  RawConnection(RawConnection&& other) noexcept : socket_(std::exchange(other.socket_, -1)), is_open_(other.is_open_) {}
  RawConnection& operator=(RawConnection&& other) = delete;
  ~RawConnection() {
    if (socket_ >= 0) ::close(socket_);
  }
  [[nodiscard]] bool is_open() const { return is_open_; }

  /// False if the other side has closed the connection.
  bool send(std::string_view bytes) const {
    while (!bytes.empty()) {
      const ssize_t count = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (count <= 0) return false;
      bytes.remove_prefix(static_cast<std::size_t>(count));
    }
    return true;
  }
  /// Reads until the connection ends, or an answer with its body is complete. Empty after ten seconds without either.
  [[nodiscard]] std::string receive() const {
    std::string bytes;
    while (!is_complete(bytes)) {
      pollfd waiting{socket_, POLLIN, 0};
      if (::poll(&waiting, 1, 10000) != 1) return {};
      char buffer[1 << 16];
      const ssize_t count = ::recv(socket_, buffer, sizeof(buffer), 0);
      if (count <= 0) return bytes;
      bytes.append(buffer, static_cast<std::size_t>(count));
    }
    return bytes;
  }
  /// Reads until the bytes end with `end`, the connection ends, or ten seconds pass without any.
  [[nodiscard]] std::string receive_until(std::string_view end) const {
    std::string bytes;
    while (!bytes.ends_with(end)) {
      pollfd waiting{socket_, POLLIN, 0};
      if (::poll(&waiting, 1, 10000) != 1) return bytes;
      char buffer[1 << 16];
      const ssize_t count = ::recv(socket_, buffer, sizeof(buffer), 0);
      if (count <= 0) return bytes;
      bytes.append(buffer, static_cast<std::size_t>(count));
    }
    return bytes;
  }
  [[nodiscard]] std::string ask(std::string_view request) const {
    send(request);
    return receive();
  }

 private:
  static bool is_complete(const std::string& bytes) {
    const std::size_t header = bytes.find("\r\n\r\n");
    const std::size_t length = bytes.find("Content-Length: ");
    if (header == bytes.npos || length == bytes.npos || length > header) return false;
    return bytes.size() >= header + 4 + std::stoul(bytes.substr(length + 16));
  }
  int socket_;
  bool is_open_ = false;
};

/// The status of an answer, or 0.
inline int status_of(const std::string& answer) {
  return answer.starts_with("HTTP/1.1 ") ? std::stoi(answer.substr(9, 3)) : 0;
}
inline std::string body_of(const std::string& answer) {
  const std::size_t header = answer.find("\r\n\r\n");
  return header == answer.npos ? std::string() : answer.substr(header + 4);
}

/// A server that runs until the end of the test.
class RunningServer {
 public:
  explicit RunningServer(HttpHandler handler, const HttpLimits& limits = {})
      : server_(HttpServer::listen(0, std::move(handler), limits).value()), thread_([this] { server_.run(); }) {}
  ~RunningServer() { stop(); }
  RunningServer(const RunningServer&) = delete;
  RunningServer& operator=(const RunningServer&) = delete;
  [[nodiscard]] RawConnection connect() const { return RawConnection(server_.port()); }
  [[nodiscard]] std::string ask(std::string_view request) const { return connect().ask(request); }
  [[nodiscard]] std::uint16_t port() const { return server_.port(); }
  [[nodiscard]] const HttpServer& server() const { return server_; }
  void send_event(const std::string& data) { server_.send_event(data); }
  void stop() {
    if (!thread_.joinable()) return;
    server_.stop();
    thread_.join();
  }

 private:
  HttpServer server_;
  std::thread thread_;
};

}  // namespace resight::test
