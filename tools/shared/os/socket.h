#pragma once
// A connection that an HTTP library has accepted.
#include <cstddef>
#include <cstdint>

namespace ngs::os {

using Socket = std::intptr_t;

enum class SocketEvent { kReadable, kWritable };
bool socket_is_ready(Socket socket, SocketEvent event, std::int64_t milliseconds);
/// Both return a number of bytes; negative: failed. send_now() raises no signal and does not wait.
std::int64_t receive_some(Socket socket, void* to, std::size_t bytes);
std::int64_t send_now(Socket socket, const void* from, std::size_t bytes);
void close_socket(Socket socket);
/// Before a socket is bound: its port can be bound again right after the program ends, but not while another listens.
void make_exclusive(Socket socket);

}  // namespace ngs::os
