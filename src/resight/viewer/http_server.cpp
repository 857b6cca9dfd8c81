// SPDX-License-Identifier: Apache-2.0
#include "resight/viewer/http_server.hpp"

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http.hpp>
#include <chrono>
#include <csignal>
#include <exception>
#include <optional>
#include <utility>
#include <vector>

#include "resight/viewer/internal/http_parser.hpp"

namespace resight {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
using asio::ip::tcp;
using ErrorCode = boost::system::error_code;

// A client that was refused may still be sending. Its bytes are read for a while, so that it sees the answer.
constexpr std::size_t kMaxDrainedBytes = 16 << 20;
constexpr std::size_t kMaxReadBytes = 1 << 16;  // At once.
constexpr double kDrainTime_s = 2;

std::chrono::steady_clock::duration to_duration(double seconds) {
  return std::chrono::duration_cast<std::chrono::steady_clock::duration>(std::chrono::duration<double>(seconds));
}

/// Refuses everything that is not from this server, and all use of the page by other pages.
constexpr const char* kContentSecurityPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; connect-src 'self'; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

using SharedBody = http::span_body<const char>;

void set_headers(const HttpResponse& content, http::response<SharedBody>& response) {
  response.set(http::field::content_type, content.content_type);
  response.set(http::field::cache_control, "no-store");
  response.set("Content-Security-Policy", kContentSecurityPolicy);
  response.set("Cross-Origin-Resource-Policy", "same-origin");
  response.set("X-Content-Type-Options", "nosniff");
  response.set("Referrer-Policy", "no-referrer");
  if (content.status == 405) response.set(http::field::allow, content.allowed_methods);
}

class Connection;

/// What the connections of a server share.
struct ServerState {
  HttpHandler handler;
  HttpLimits limits;
  int num_connections = 0;
  std::vector<std::weak_ptr<Connection>> streams;  ///< Those that get events.
};

std::string format_event(const std::string& data) { return "data: " + data + "\n\n"; }

/// One connection: reads a request, answers it, and so on, until either side ends it or a limit is exceeded.
class Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(tcp::socket socket, std::shared_ptr<ServerState> server)
      : socket_(std::move(socket)),
        timer_(socket_.get_executor()),
        server_(std::move(server)),
        buffer_(server_->limits.max_header_bytes + kMaxReadBytes) {
    ++server_->num_connections;
  }
  ~Connection() { --server_->num_connections; }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  void start() { read(); }
  void refuse(int status, std::string text) { answer(make_text_response(status, std::move(text)), false); }
  /// For a stream.
  void send_event(const std::string& event) {
    if (is_writing_)
      waiting_event_ = event;
    else
      write_event(event);
  }

 private:
  void set_deadline(double seconds) {
    is_late_ = false;
    timer_.expires_after(to_duration(seconds));
    timer_.async_wait([self = shared_from_this()](ErrorCode error) {
      if (error) return;
      self->is_late_ = true;
      ErrorCode ignored;
      self->socket_.cancel(ignored);
    });
  }

  void read() {
    parser_.emplace();
    viewer::set_limits(server_->limits, *parser_);
    set_deadline(server_->limits.request_time_s);
    http::async_read(socket_, buffer_, *parser_, [self = shared_from_this()](ErrorCode error, std::size_t) {
      self->timer_.cancel();
      self->on_read(error);
    });
  }

  void on_read(ErrorCode error) {
    if (!error) return answer(call_handler(), parser_->get().keep_alive());
    if (is_late_ && parser_->got_some()) return refuse(408, "the request took too long");
    if (is_late_ || error == http::error::end_of_stream) return close();
    // Extensions of chunks and trailers are headers that the parser does not count.
    if (error == http::error::header_limit || error == http::error::buffer_overflow)
      return refuse(431, "the header is too long");
    if (error == http::error::body_limit) return refuse(413, "the body is too long");
    if (error.category() == http::make_error_code(http::error::bad_method).category() &&
        error != http::error::partial_message)
      return refuse(400, "this is not a valid HTTP request");
    close();
  }

  [[nodiscard]] HttpResponse call_handler() const {
    try {
      return server_->handler(viewer::to_request(parser_->get()));
    } catch (const std::exception& failure) {
      return make_text_response(500, std::string("failed: ") + failure.what());
    }
  }

  void answer(HttpResponse content, bool keep_alive) {
    content_ = std::move(content.body);
    if (!content_) content_ = std::make_shared<const std::string>();
    response_ = http::response<SharedBody>(static_cast<http::status>(content.status), 11);
    set_headers(content, response_);
    if (content.is_event_stream) return start_stream();
    response_.body() = {content_->data(), content_->size()};
    response_.keep_alive(keep_alive);
    response_.prepare_payload();
    set_deadline(server_->limits.response_time_s);
    http::async_write(socket_, response_, [self = shared_from_this(), keep_alive](ErrorCode error, std::size_t) {
      self->timer_.cancel();
      if (error) return self->close();
      if (keep_alive) return self->read();
      self->drain();
    });
  }

  /// The answer has no length: it ends with the connection.
  void start_stream() {
    server_->streams.push_back(weak_from_this());
    response_.keep_alive(false);
    serializer_.emplace(response_);
    is_writing_ = true;
    set_deadline(server_->limits.response_time_s);
    http::async_write_header(socket_, *serializer_, [self = shared_from_this()](ErrorCode error, std::size_t) {
      self->is_writing_ = false;
      if (error) return self->close();
      self->write_event(format_event(*self->content_));
      self->watch_stream();
    });
  }
  void write_event(std::string event) {
    is_writing_ = true;
    event_ = std::move(event);
    set_deadline(server_->limits.response_time_s);
    asio::async_write(socket_, asio::buffer(event_), [self = shared_from_this()](ErrorCode error, std::size_t) {
      self->is_writing_ = false;
      if (error) return self->close();
      if (self->waiting_event_) return self->write_event(*std::exchange(self->waiting_event_, std::nullopt));
      self->wait_for_event();
    });
  }
  void wait_for_event() {
    timer_.expires_after(to_duration(server_->limits.heartbeat_s));
    timer_.async_wait([self = shared_from_this()](ErrorCode error) {
      if (!error && !self->is_writing_) self->write_event(":\n\n");
    });
  }
  /// A client that says anything more, or leaves, ends its stream.
  void watch_stream() {
    buffer_.clear();
    socket_.async_read_some(buffer_.prepare(1), [self = shared_from_this()](ErrorCode, std::size_t) { self->close(); });
  }

  void drain() {
    ErrorCode ignored;
    socket_.shutdown(tcp::socket::shutdown_send, ignored);
    set_deadline(kDrainTime_s);
    drain_some(0);
  }
  void drain_some(std::size_t num_drained) {
    buffer_.clear();
    socket_.async_read_some(buffer_.prepare(kMaxReadBytes),
                            [self = shared_from_this(), num_drained](ErrorCode error, std::size_t num_read) {
                              if (error || num_drained > kMaxDrainedBytes) return self->close();
                              self->drain_some(num_drained + num_read);
                            });
  }

  void close() {
    timer_.cancel();
    ErrorCode ignored;
    socket_.close(ignored);
  }

  tcp::socket socket_;
  asio::steady_timer timer_;
  std::shared_ptr<ServerState> server_;
  beast::flat_buffer buffer_;  ///< What has been read and not been parsed yet.
  std::optional<viewer::HttpParser> parser_;
  std::shared_ptr<const std::string> content_;
  http::response<SharedBody> response_;
  std::optional<http::response_serializer<SharedBody>> serializer_;  ///< Of the header of a stream.
  std::string event_;                                                ///< That is being written.
  std::optional<std::string> waiting_event_;
  bool is_writing_ = false;
  bool is_late_ = false;
};

}  // namespace

class HttpServer::Impl {
 public:
  Impl(HttpHandler handler, const HttpLimits& limits)
      : state_(std::make_shared<ServerState>(ServerState{std::move(handler), limits, 0, {}})), acceptor_(context_) {}

  Result<void> listen(std::uint16_t port) {
    const tcp::endpoint here(asio::ip::address_v4::loopback(), port);
    ErrorCode error;
    acceptor_.open(here.protocol(), error);
    if (!error) acceptor_.set_option(asio::socket_base::reuse_address(true), error);
    if (!error) acceptor_.bind(here, error);
    if (!error) acceptor_.listen(asio::socket_base::max_listen_connections, error);
    if (error) return Error{"port " + std::to_string(port) + " of 127.0.0.1: " + error.message()};
    accept();
    return {};
  }

  [[nodiscard]] std::uint16_t port() const { return acceptor_.local_endpoint().port(); }
  [[nodiscard]] int num_connections() const { return state_->num_connections; }

  void run() {
    context_.run();
    context_.restart();
  }
  void catch_interrupts() {
    if (interrupts_) return;
    interrupts_.emplace(context_, SIGINT, SIGTERM);
    interrupts_->async_wait([this](ErrorCode error, int) {
      if (!error) context_.stop();
    });
  }
  void run_until_interrupted() {
    catch_interrupts();
    run();
    interrupts_.reset();
  }
  void stop() {
    asio::post(context_, [this] { context_.stop(); });
  }
  void send_event(const std::string& data) {
    asio::post(context_, [this, event = format_event(data)] {
      std::erase_if(state_->streams, [](const auto& stream) { return stream.expired(); });
      for (const auto& stream : state_->streams) stream.lock()->send_event(event);
    });
  }

 private:
  void accept() {
    acceptor_.async_accept([this](ErrorCode error, tcp::socket socket) {
      if (error == asio::error::operation_aborted) return;
      if (!error) serve(std::move(socket));
      if (error) return accept_later();  // usually, no file descriptor is free
      accept();
    });
  }
  void accept_later() {
    retry_.expires_after(std::chrono::milliseconds(100));
    retry_.async_wait([this](ErrorCode error) {
      if (!error) accept();
    });
  }
  void serve(tcp::socket socket) {
    ErrorCode ignored;
    socket.set_option(tcp::no_delay(true), ignored);
    const bool is_full = state_->num_connections >= state_->limits.max_connections;
    const auto connection = std::make_shared<Connection>(std::move(socket), state_);
    if (is_full) return connection->refuse(503, "too many connections");
    connection->start();
  }

  std::shared_ptr<ServerState> state_;
  asio::io_context context_{1};
  tcp::acceptor acceptor_;
  asio::steady_timer retry_{context_};
  std::optional<asio::signal_set> interrupts_;
};

HttpServer::HttpServer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
HttpServer::HttpServer(HttpServer&& other) noexcept = default;
HttpServer& HttpServer::operator=(HttpServer&& other) noexcept = default;
HttpServer::~HttpServer() = default;

Result<HttpServer> HttpServer::listen(std::uint16_t port, HttpHandler handler, const HttpLimits& limits) {
  auto impl = std::make_unique<Impl>(std::move(handler), limits);
  if (const auto listening = impl->listen(port); !listening) return listening.error();
  return HttpServer(std::move(impl));
}

std::uint16_t HttpServer::port() const { return impl_->port(); }
int HttpServer::num_connections() const { return impl_->num_connections(); }
void HttpServer::run() { impl_->run(); }
void HttpServer::catch_interrupts() { impl_->catch_interrupts(); }
void HttpServer::run_until_interrupted() { impl_->run_until_interrupted(); }
void HttpServer::stop() { impl_->stop(); }
void HttpServer::send_event(const std::string& data) { impl_->send_event(data); }

}  // namespace resight
