#pragma once
// HTTP server on the loopback address for one user: access is checked, sizes and times are bounded, and only the
// embedded page files are served.
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "requests.h"

namespace ngs::studio {

// Access control: requests need the token, as a cookie (browser) or as a header (scripts).

/// Headers of a request. An absent header is empty.
struct Caller {
  std::string host, origin, cookies, token;  // token: the header X-Ngs-Token
};

class Access {
 public:
  /// `port` is part of the cookie's name.
  Access(std::string token, int port);

  bool allows(const Caller& caller) const { return is_same_origin(caller) && has_token(caller); }
  /// True if Host is a local name with any port, as behind a tunnel of ssh, and Origin is absent or the same server.
  bool is_same_origin(const Caller& caller) const;
  bool is_token(std::string_view text) const;
  std::string cookie() const;
  const std::string& token() const { return token_; }

 private:
  bool has_token(const Caller& caller) const;

  std::string token_, cookie_name_;
};

/// 128 random bits in hexadecimal digits.
std::string random_token();

/// "GET" or "POST", a path that begins with /api/, and the body. Must be thread-safe.
using Answer = std::function<Reply(const std::string& method, const std::string& path, const std::string& body)>;

class Server {
 public:
  /// Binds the port; 0: any free port. Throws kEnvironment if that fails.
  Server(int port, Answer answer);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  int port() const;
  /// The address to open, including the token.
  std::string url() const;
  /// Serves in background threads until this object is destroyed.
  void start();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace ngs::studio
