#pragma once
// Child processes, each with its own group of processes that it starts, and channels to them.
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace ngs::os {

/// Standard streams of a program; -1: empty.
struct Descriptors {
  int in = -1, out = -1, err = -1;
};

class Process {
 public:
  Process() = default;
  ~Process();
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  /// Signal handlers are reset. Returns 0, or the errno that tells why it cannot be started.
  int start(const std::vector<std::string>& argv, const Descriptors& descriptors);
  bool is_started() const { return process_ != 0; }

  enum class State { kRunning, kExited, kSignalled, kLost };  // kLost, with errno set: its exit code is unknown
  struct Status {
    State state;
    int code = 0;  // exit code or signal number
  };
  /// Must not be called again after it has reported the end of the process.
  Status poll();
  /// Requests all processes of the group to end; on Windows the child, which ends its own children.
  void request_end() const;
  /// Ends all processes of the group, also those that remain after the child has ended.
  void kill() const;
  /// Forgets a process that has ended: is_started() becomes false.
  void release();

 private:
  std::intptr_t process_ = 0, group_ = 0;  // POSIX: its id. Windows: handles of the process and of a job
};

struct Channels {
  int to = -1, from = -1;  // this process's ends
  int of_child_in = -1, of_child_out = -1;
};
bool open_channels(Channels& channels);
/// Writing to a process that has ended fails and raises no signal.
std::int64_t send_some(int descriptor, const void* data, std::size_t bytes);
/// True if read_some() would not wait: bytes arrived, or the other end was closed.
bool is_readable_within(int descriptor, int milliseconds);
std::int64_t read_some(int descriptor, void* to, std::size_t bytes);

/// Replaces this process by another program, or waits for it and ends with its exit code. Returns errno on failure.
int become(const std::vector<std::string>& argv);

}  // namespace ngs::os
