#pragma once
// Runs ngs-studio as a server process and sends raw requests to it.
#include <sys/types.h>

#include <string>
#include <vector>

namespace ngs::test {

/// Whether the tool was built; it is not built without cpp-httplib.
bool has_studio();

class StudioServer {
 public:
  /// Starts the tool in `folder` with the additional arguments `words`, and waits until it prints its address.
  StudioServer(const std::string& folder, std::vector<std::string> words);
  ~StudioServer();
  StudioServer(const StudioServer&) = delete;
  StudioServer& operator=(const StudioServer&) = delete;

  int port() const { return port_; }
  const std::string& token() const { return token_; }
  bool is_alive() const;

  /// Sends the bytes and reads until the server closes the connection, or `timeout_s` after the last byte.
  std::string send(const std::string& bytes, double timeout_s = 10) const;
  struct Answer {
    int status = 0;
    std::string headers, body;
  };
  /// A request with the headers of the studio's page; with a body it is a POST.
  Answer get(const std::string& path) const;
  Answer post(const std::string& path, const std::string& body) const;
  static Answer parsed(const std::string& bytes);
  /// Sends POST /api/quit and returns the exit code.
  int quit();

 private:
  pid_t process_ = 0;
  int port_ = 0;
  std::string token_, startup_output_;
};

}  // namespace ngs::test
