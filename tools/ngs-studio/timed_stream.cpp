#include "timed_stream.h"

#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cstring>

namespace ngs::studio {

using std::chrono::milliseconds;

bool TimedStream::wait_for_request(milliseconds patience, milliseconds request_time) {
  if (begin_ == end_ && !ready(POLLIN, patience)) return false;
  deadline_ = std::chrono::steady_clock::now() + request_time;
  return true;
}

milliseconds TimedStream::left() const {
  return std::chrono::ceil<milliseconds>(
      std::max(std::chrono::steady_clock::duration::zero(), deadline_ - std::chrono::steady_clock::now()));
}

bool TimedStream::ready(short event, milliseconds patience) const {
  pollfd wanted{socket_, event, 0};
  return poll(&wanted, 1, int(patience.count())) > 0 && (wanted.revents & event) != 0;
}

bool TimedStream::is_readable() const { return begin_ < end_ || ready(POLLIN, left()); }
bool TimedStream::is_writable() const { return ready(POLLOUT, milliseconds(0)); }

ssize_t TimedStream::read(char* to, std::size_t size) {
  if (begin_ == end_) {
    if (left().count() == 0 || !ready(POLLIN, left())) return -1;
    const ssize_t got = recv(socket_, buffer_, sizeof buffer_, 0);
    if (got <= 0) return got;
    begin_ = 0, end_ = std::size_t(got);
  }
  const std::size_t some = std::min(size, end_ - begin_);
  std::memcpy(to, buffer_ + begin_, some);
  begin_ += some;
  return ssize_t(some);
}

/// The answer has its own time: working it out may have taken all of the request's.
ssize_t TimedStream::write(const char* from, std::size_t size) {
  constexpr milliseconds kPatience(5000);
  return ready(POLLOUT, kPatience) ? send(socket_, from, size, MSG_NOSIGNAL | MSG_DONTWAIT) : -1;
}

}  // namespace ngs::studio
