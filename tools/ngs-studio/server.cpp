#include "server.h"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <random>
#include <thread>

#include "httplib.h"
#include "ngs/core/error.h"
#include "page_files.h"
#include "shared/os/socket.h"

namespace ngs::studio {
namespace {

using std::chrono::milliseconds;

constexpr std::size_t kMaxBody = 1 << 20;
constexpr std::size_t kThreads = 24;  // a browser opens six connections
constexpr std::chrono::milliseconds kIdle(3000), kRequest(8000);
constexpr std::size_t kMaxRequests = 100'000;  // per connection

const char* type_of(std::string_view path) {
  return path.ends_with(".js")    ? "text/javascript; charset=utf-8"
         : path.ends_with(".css") ? "text/css; charset=utf-8"
                                  : "text/html; charset=utf-8";
}

Caller caller_of(const httplib::Request& request) {
  return {request.get_header_value("Host"), request.get_header_value("Origin"), request.get_header_value("Cookie"),
          request.get_header_value("X-Ngs-Token")};
}

/// The connection of this thread closes after the current response, since the request was not read.
thread_local bool close_connection = false;

/// A connection with a deadline for each request: a client that sends single bytes slowly is disconnected.
class TimedStream : public httplib::Stream {
 public:
  explicit TimedStream(socket_t socket) : socket_(socket) {}

  /// Waits for the first byte of the next request, which starts the deadline; false: no byte came.
  bool wait_for_request(milliseconds timeout, milliseconds request_time) {
    if (begin_ == end_ && !ready(os::SocketEvent::kReadable, timeout)) return false;
    deadline_ = std::chrono::steady_clock::now() + request_time;
    return true;
  }

  bool is_readable() const override { return begin_ < end_ || ready(os::SocketEvent::kReadable, left()); }
  bool is_writable() const override { return ready(os::SocketEvent::kWritable, milliseconds(0)); }
  ssize_t read(char* to, std::size_t size) override {
    if (begin_ == end_) {
      if (left().count() == 0 || !ready(os::SocketEvent::kReadable, left())) return -1;
      const std::int64_t got = os::receive_some(os::Socket(socket_), buffer_, sizeof buffer_);
      if (got <= 0) return ssize_t(got);
      begin_ = 0;
      end_ = std::size_t(got);
    }
    const std::size_t some = std::min(size, end_ - begin_);
    std::memcpy(to, buffer_ + begin_, some);
    begin_ += some;
    return ssize_t(some);
  }
  /// The response has its own time limit: computing it may have used up that of the request.
  ssize_t write(const char* from, std::size_t size) override {
    constexpr milliseconds kTimeout(5000);
    return ready(os::SocketEvent::kWritable, kTimeout) ? ssize_t(os::send_now(os::Socket(socket_), from, size)) : -1;
  }
  void get_remote_ip_and_port(std::string& ip, int& port) const override {
    ip = "127.0.0.1";
    port = 0;
  }
  void get_local_ip_and_port(std::string& ip, int& port) const override {
    ip = "127.0.0.1";
    port = 0;
  }
  socket_t socket() const override { return socket_; }

 private:
  bool ready(os::SocketEvent event, milliseconds timeout) const {
    return os::socket_is_ready(os::Socket(socket_), event, timeout.count());
  }
  milliseconds left() const {
    return std::chrono::ceil<milliseconds>(
        std::max(std::chrono::steady_clock::duration::zero(), deadline_ - std::chrono::steady_clock::now()));
  }

  socket_t socket_;
  std::chrono::steady_clock::time_point deadline_{};
  char buffer_[4096] = {};
  std::size_t begin_ = 0, end_ = 0;
};

/// httplib's server with a deadline per request.
class TimedServer : public httplib::Server {
 private:
  bool process_and_close_socket(socket_t socket) override {
    TimedStream stream(socket);
    bool keep_alive = true;
    close_connection = false;
    for (std::size_t n = 1; keep_alive && svr_sock_ != INVALID_SOCKET && stream.wait_for_request(kIdle, kRequest);
         ++n) {
      bool closed = false;
      keep_alive = process_request(stream, n == kMaxRequests, closed, nullptr) && !closed && !close_connection;
    }
    os::close_socket(os::Socket(socket));
    return keep_alive;
  }
};

}  // namespace

struct Server::Impl {
  TimedServer http;
  Answer answer;
  int port = 0;
  std::unique_ptr<Access> access;
  std::thread thread;

  void set_up() {
    http.new_task_queue = [] { return new httplib::ThreadPool(kThreads); };
    http.set_payload_max_length(kMaxBody);
    http.set_tcp_nodelay(true);
    http.set_keep_alive_max_count(kMaxRequests);
    http.set_keep_alive_timeout(kIdle.count() / 1000);
    http.set_default_headers({{"Cache-Control", "no-store"},
                              {"X-Content-Type-Options", "nosniff"},
                              {"Referrer-Policy", "no-referrer"},
                              {"Content-Security-Policy",
                               "default-src 'self'; img-src 'self' blob: data:; object-src 'none'; base-uri 'none'; "
                               "form-action 'none'; frame-ancestors 'none'"}});
    http.set_pre_routing_handler(
        [this](const httplib::Request& request, httplib::Response& response) { return admit(request, response); });
    for (const PageFile& file : page_files()) {
      const auto serve = [&file](const httplib::Request&, httplib::Response& response) {
        response.set_content(std::string(file.bytes), type_of(file.path));
      };
      http.Get(std::string(file.path == "/index.html" ? "/" : file.path), serve);
    }
    const auto pass_on = [this](const httplib::Request& request, httplib::Response& response) {
      const Reply reply = answer(request.method, request.path, request.body);
      response.status = reply.status;
      response.set_content(reply.body, reply.type);
      for (const auto& [name, value] : reply.headers) response.set_header(name, value);
    };
    http.Get("/api/[a-z]+", pass_on);
    http.Post("/api/[a-z]+", pass_on);
    http.set_error_handler([](const httplib::Request& request, httplib::Response& response) {
      if (!response.body.empty()) return;
      const Reply reply = reply_of({response.status, request.method + " " + request.path,
                                    httplib_reason(response.status), "a request of data-schema/studio-protocol.md"});
      response.set_content(reply.body, reply.type);
    });
  }

  static std::string httplib_reason(int status) {
    switch (status) {
      case 404: return "unknown path";
      case 413: return "a body of more than 1 MiB";
      default: return "a malformed request";
    }
  }

  httplib::Server::HandlerResponse admit(const httplib::Request& request, httplib::Response& response) {
    const Caller caller = caller_of(request);
    if (request.method == "GET" && request.path == "/" && access->is_same_origin(caller) &&
        request.has_param("token") && access->is_token(request.get_param_value("token"))) {
      response.set_header("Set-Cookie", access->cookie());
      response.set_redirect("/", 303);
      return httplib::Server::HandlerResponse::Handled;
    }
    if (!access->allows(caller)) return refuse(response, {403, "", "", ""});
    if (request.method != "POST") return httplib::Server::HandlerResponse::Unhandled;
    // Without Content-Length, or with compression, the size of the body is not bounded in advance.
    if (request.has_header("Transfer-Encoding") || !request.has_header("Content-Length"))
      return refuse(response, {411, "request", "a body without Content-Length", "a Content-Length header"});
    const std::string length = request.get_header_value("Content-Length");
    if (length.size() > 7 || std::strtoull(length.c_str(), nullptr, 10) > kMaxBody)
      return refuse(response, {413, "request", "a body of " + length.substr(0, 20) + " bytes", "at most 1 MiB"});
    if (request.has_header("Content-Encoding"))
      return refuse(response, {415, "request", "a compressed body", "plain JSON"});
    if (!request.get_header_value("Content-Type").starts_with("application/json"))
      return refuse(response,
                    {415, "request", "Content-Type " + request.get_header_value("Content-Type"), "application/json"});
    return httplib::Server::HandlerResponse::Unhandled;
  }

  static httplib::Server::HandlerResponse refuse(httplib::Response& response, const Refusal& refusal) {
    response.status = refusal.status;
    if (refusal.status == 403)
      response.set_content("ngs-studio: access denied, open the address that it printed, with its token\n",
                           "text/plain; charset=utf-8");
    else
      response.set_content(reply_of(refusal).body, "application/json");
    response.set_header("Connection", "close");
    close_connection = true;
    return httplib::Server::HandlerResponse::Handled;
  }
};

Server::Server(int port, Answer answer) : impl_(std::make_unique<Impl>()) {
  impl_->answer = std::move(answer);
  impl_->port = port;
  impl_->http.set_socket_options([](socket_t socket) { os::make_exclusive(os::Socket(socket)); });
  if (port == 0)
    impl_->port = impl_->http.bind_to_any_port("127.0.0.1");
  else if (!impl_->http.bind_to_port("127.0.0.1", port))
    impl_->port = -1;
  if (impl_->port <= 0)
    throw Error(ErrorCode::kEnvironment,
                "port " + std::to_string(port) + ": is in use or not allowed, expected a free port",
                "stop the other program, or leave out --port to use any free port");
  impl_->access = std::make_unique<Access>(random_token(), impl_->port);
  impl_->set_up();
}

Server::~Server() {
  impl_->http.stop();
  if (impl_->thread.joinable()) impl_->thread.join();
}

int Server::port() const { return impl_->port; }

std::string Server::url() const {
  return "http://127.0.0.1:" + std::to_string(impl_->port) + "/?token=" + impl_->access->token();
}

void Server::start() {
  impl_->thread = std::thread([this] { impl_->http.listen_after_bind(); });
}

Access::Access(std::string token, int port)
    : token_(std::move(token)), cookie_name_("ngs-studio-" + std::to_string(port)) {}

bool Access::is_same_origin(const Caller& caller) const {
  const std::size_t digits = caller.host.find(':') + 1;
  const std::string name = caller.host.substr(0, digits);
  if (name != "127.0.0.1:" && name != "localhost:") return false;
  if (digits == caller.host.size() || caller.host.find_first_not_of("0123456789", digits) != caller.host.npos)
    return false;
  return caller.origin.empty() || caller.origin == "http://" + caller.host;
}

/// Compares in constant time.
bool Access::is_token(std::string_view text) const {
  if (text.size() != token_.size()) return false;
  unsigned differs = 0;
  for (std::size_t i = 0; i < text.size(); ++i) differs |= unsigned(text[i] ^ token_[i]);
  return differs == 0;
}

bool Access::has_token(const Caller& caller) const {
  if (is_token(caller.token)) return true;
  std::string_view rest = caller.cookies;
  while (!rest.empty()) {
    const std::size_t end = rest.find(';');
    std::string_view one = rest.substr(0, end);
    rest = end == rest.npos ? std::string_view() : rest.substr(end + 1);
    while (one.starts_with(' ')) one.remove_prefix(1);
    const std::size_t equals = one.find('=');
    if (equals != one.npos && one.substr(0, equals) == cookie_name_ && is_token(one.substr(equals + 1))) return true;
  }
  return false;
}

std::string Access::cookie() const { return cookie_name_ + "=" + token_ + "; HttpOnly; SameSite=Strict; Path=/"; }

std::string random_token() {
  static const char* const digits = "0123456789abcdef";
  std::random_device random;
  std::string token;
  while (token.size() < 32) token += digits[random() % 16];
  return token;
}

}  // namespace ngs::studio
