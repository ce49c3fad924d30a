#pragma once
// HTTP server on the loopback address for one user: access is checked, sizes and times are bounded, and only the
// embedded page files are served.
#include <functional>
#include <memory>
#include <string>

#include "access.h"
#include "reply.h"

namespace ngs::studio {

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
