#pragma once
// ngs-studio as a process that serves, and raw requests to it.
#include <sys/types.h>

#include <string>
#include <vector>

namespace ngs::test {

/// Whether the tool was built: it is left out where cpp-httplib is not installed.
bool has_studio();

class StudioServer {
 public:
  /// Starts it in `folder` with these words behind its name, and waits until it says where it listens.
  StudioServer(const std::string& folder, std::vector<std::string> words);
  ~StudioServer();
  StudioServer(const StudioServer&) = delete;
  StudioServer& operator=(const StudioServer&) = delete;

  int port() const { return port_; }
  const std::string& token() const { return token_; }
  bool is_alive() const;
  /// What it wrote on stderr until it said where it listens.
  const std::string& said() const { return said_; }

  /// Sends the bytes and reads all that comes until the other side closes, or `patience_s` after the last byte.
  std::string send(const std::string& bytes, double patience_s = 10) const;
  struct Answer {
    int status = 0;
    std::string headers, body;
  };
  /// A request as the page makes it; a POST where there is a body.
  Answer get(const std::string& path) const;
  Answer post(const std::string& path, const std::string& body) const;
  static Answer parsed(const std::string& bytes);
  /// POST /api/quit, and the exit code.
  int quit();

 private:
  pid_t process_ = 0;
  int port_ = 0;
  std::string token_, said_;
};

}  // namespace ngs::test
