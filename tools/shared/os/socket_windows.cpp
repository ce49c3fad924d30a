#include <winsock2.h>

#include <algorithm>

#include "shared/os/socket.h"

namespace ngs::os {
namespace {

constexpr std::size_t kAtOnceBytes = 1 << 16;  // a blocking socket accepts that much at once when it is writable

}  // namespace

bool socket_is_ready(Socket socket, SocketEvent event, std::int64_t milliseconds) {
  const short events = event == SocketEvent::kReadable ? POLLRDNORM : POLLWRNORM;
  WSAPOLLFD wanted{SOCKET(socket), events, 0};
  return WSAPoll(&wanted, 1, int(milliseconds)) > 0 && (wanted.revents & (events | POLLHUP)) != 0;
}

std::int64_t receive_some(Socket socket, void* to, std::size_t bytes) {
  return ::recv(SOCKET(socket), static_cast<char*>(to), int(bytes), 0);
}

std::int64_t send_now(Socket socket, const void* from, std::size_t bytes) {
  return ::send(SOCKET(socket), static_cast<const char*>(from), int(std::min(bytes, kAtOnceBytes)), 0);
}

void close_socket(Socket socket) {
  ::shutdown(SOCKET(socket), SD_BOTH);
  ::closesocket(SOCKET(socket));
}

void make_exclusive(Socket socket) {
  const int yes = 1;
  ::setsockopt(SOCKET(socket), SOL_SOCKET, SO_EXCLUSIVEADDRUSE, reinterpret_cast<const char*>(&yes), sizeof yes);
}

}  // namespace ngs::os
