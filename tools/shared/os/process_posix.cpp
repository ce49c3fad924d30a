#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>

#include "shared/os/process.h"

extern char** environ;

namespace ngs::os {
namespace {

std::vector<char*> words_of(const std::vector<std::string>& argv) {
  std::vector<char*> words;
  for (const std::string& word : argv) words.push_back(const_cast<char*>(word.c_str()));
  words.push_back(nullptr);
  return words;
}

}  // namespace

Process::~Process() = default;

int Process::start(const std::vector<std::string>& argv, const Descriptors& given) {
  const std::vector<char*> words = words_of(argv);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  if (given.in < 0)
    posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  else
    posix_spawn_file_actions_adddup2(&files, given.in, STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&files, given.out, STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&files, given.err, STDERR_FILENO);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none, defaults;
  sigemptyset(&none);
  sigemptyset(&defaults);
  for (const int number : {SIGTERM, SIGINT, SIGUSR1, SIGPIPE, SIGXFSZ, SIGCHLD}) sigaddset(&defaults, number);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setsigdefault(&attributes, &defaults);
  posix_spawnattr_setflags(&attributes, short(POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF));
  pid_t child = 0;
  const int status = posix_spawnp(&child, words[0], &files, &attributes, words.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&files);
  if (status == 0) process_ = group_ = child;
  return status;
}

Process::Status Process::poll() {
  int status = 0;
  const pid_t ended = waitpid(pid_t(process_), &status, WNOHANG);
  if (ended == 0 || (ended < 0 && errno == EINTR)) return {State::kRunning};
  if (ended < 0) return {State::kLost};
  if (WIFSIGNALED(status)) return {State::kSignalled, WTERMSIG(status)};
  return {State::kExited, WEXITSTATUS(status)};
}

void Process::request_end() const { ::kill(-pid_t(group_), SIGTERM); }
void Process::kill() const { ::kill(-pid_t(group_), SIGKILL); }
void Process::release() { process_ = 0; }

bool open_channels(Channels& channels) {
  // A socket, because writing to a pipe without a reader would end this process by SIGPIPE.
  int socket[2], pipe[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, socket) != 0) return false;
  channels.to = socket[0];
  channels.of_child_in = socket[1];
  if (pipe2(pipe, O_CLOEXEC) != 0) return false;
  channels.from = pipe[0];
  channels.of_child_out = pipe[1];
  return true;
}

std::int64_t send_some(int descriptor, const void* data, std::size_t bytes) {
  const ssize_t count = ::send(descriptor, data, bytes, MSG_NOSIGNAL);
  return count < 0 && errno == EINTR ? 0 : count;
}

bool is_readable_within(int descriptor, int milliseconds) {
  pollfd readable{.fd = descriptor, .events = POLLIN, .revents = 0};
  return ::poll(&readable, 1, milliseconds) > 0;
}

std::int64_t read_some(int descriptor, void* to, std::size_t bytes) { return ::read(descriptor, to, bytes); }

int become(const std::vector<std::string>& argv) {
  const std::vector<char*> words = words_of(argv);
  execv(words[0], words.data());
  return errno;
}

}  // namespace ngs::os
