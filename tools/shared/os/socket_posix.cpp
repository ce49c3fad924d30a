#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "shared/os/socket.h"

namespace ngs::os {

bool socket_is_ready(Socket socket, SocketEvent event, std::int64_t milliseconds) {
  const short events = event == SocketEvent::kReadable ? POLLIN : POLLOUT;
  pollfd wanted{int(socket), events, 0};
  return ::poll(&wanted, 1, int(milliseconds)) > 0 && (wanted.revents & events) != 0;
}

std::int64_t receive_some(Socket socket, void* to, std::size_t bytes) { return ::recv(int(socket), to, bytes, 0); }

std::int64_t send_now(Socket socket, const void* from, std::size_t bytes) {
  return ::send(int(socket), from, bytes, MSG_NOSIGNAL | MSG_DONTWAIT);
}

void close_socket(Socket socket) {
  ::shutdown(int(socket), SHUT_RDWR);
  ::close(int(socket));
}

void make_exclusive(Socket socket) {
  const int yes = 1;  // on POSIX it does not allow two listeners, unlike SO_REUSEPORT
  ::setsockopt(int(socket), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
}

}  // namespace ngs::os
