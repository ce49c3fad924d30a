#pragma once
// HTTP on the loopback address for one person: who may ask is checked, sizes and times are bounded, and the files of
// the page are the only ones it knows.
#include <functional>
#include <memory>
#include <string>

#include "access.h"
#include "reply.h"

namespace ngs::studio {

/// "GET" or "POST", a path that begins with /api/, and the body. May be called by several threads at a time.
using Answer = std::function<Reply(const std::string& method, const std::string& path, const std::string& body)>;

class Server {
 public:
  /// Binds; port 0 is any that is free. kEnvironment where it cannot.
  Server(int port, Answer answer);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  int port() const;
  /// The address to open, token included.
  std::string url() const;
  /// Serves in threads of its own until the end of this object.
  void start();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace ngs::studio
