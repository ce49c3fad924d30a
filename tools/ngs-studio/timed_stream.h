#pragma once
// A connection of which every request must be over in time: one that comes a byte at a time is cut off, however
// steadily the bytes come.
#include <chrono>
#include <string>

#include "httplib.h"

namespace ngs::studio {

class TimedStream : public httplib::Stream {
 public:
  explicit TimedStream(int socket) : socket_(socket) {}

  /// Waits for the first byte of the next request; false: none came. From it on the request has its time.
  bool wait_for_request(std::chrono::milliseconds patience, std::chrono::milliseconds request_time);

  bool is_readable() const override;
  bool is_writable() const override;
  ssize_t read(char* to, std::size_t size) override;
  ssize_t write(const char* from, std::size_t size) override;
  void get_remote_ip_and_port(std::string& ip, int& port) const override { ip = "127.0.0.1", port = 0; }
  void get_local_ip_and_port(std::string& ip, int& port) const override { ip = "127.0.0.1", port = 0; }
  socket_t socket() const override { return socket_; }

 private:
  bool ready(short event, std::chrono::milliseconds patience) const;
  std::chrono::milliseconds left() const;

  int socket_;
  std::chrono::steady_clock::time_point deadline_{};
  char buffer_[4096] = {};
  std::size_t begin_ = 0, end_ = 0;
};

}  // namespace ngs::studio
