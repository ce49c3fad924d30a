#include "support/studio_server.h"

#include <arpa/inet.h>
#include <poll.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <regex>
#include <stdexcept>

namespace ngs::test {

bool has_studio() { return std::filesystem::exists(NGS_TOOL_DIR "/ngs-studio"); }

StudioServer::StudioServer(const std::string& folder, std::vector<std::string> words) {
  words.insert(words.begin(), NGS_TOOL_DIR "/ngs-studio");
  words.insert(words.end(), {"--no-browser", "-j", "2"});
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  int err[2];
  if (pipe(err) != 0) throw std::runtime_error("no pipe");
  fflush(nullptr);  // buffered output would be written twice after the fork
  process_ = fork();
  if (process_ == 0) {
    dup2(err[1], STDERR_FILENO);
    close(err[0]);
    close(err[1]);
    if (chdir(folder.c_str()) != 0 || freopen("/dev/null", "w", stdout) == nullptr) _exit(126);
    execv(argv[0], argv.data());
    _exit(127);
  }
  close(err[1]);
  const std::regex address("http://127\\.0\\.0\\.1:([0-9]+)/\\?token=([0-9a-f]+)");
  std::smatch match;
  char bytes[512];
  for (ssize_t got = 0; !std::regex_search(startup_output_, match, address);) {
    if ((got = read(err[0], bytes, sizeof bytes)) <= 0)
      throw std::runtime_error("ngs-studio ended: " + startup_output_);
    startup_output_.append(bytes, std::size_t(got));
  }
  port_ = std::stoi(match[1]);
  token_ = match[2];
  close(err[0]);
}

StudioServer::~StudioServer() {
  if (process_ <= 0) return;
  kill(process_, SIGKILL);
  waitpid(process_, nullptr, 0);
}

bool StudioServer::is_alive() const { return waitpid(process_, nullptr, WNOHANG) == 0; }

std::string StudioServer::send(const std::string& bytes, double timeout_s) const {
  const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(std::uint16_t(port_));
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (connect(socket, reinterpret_cast<sockaddr*>(&to), sizeof to) != 0) throw std::runtime_error("cannot connect");
  for (std::size_t sent = 0; sent < bytes.size();) {
    const ssize_t some = ::send(socket, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
    if (some <= 0) break;  // the server rejected the request before its end
    sent += std::size_t(some);
  }
  std::string answer;
  char buffer[4096];
  pollfd wanted{socket, POLLIN, 0};
  while (poll(&wanted, 1, int(1000 * timeout_s)) > 0) {
    const ssize_t got = recv(socket, buffer, sizeof buffer, 0);
    if (got <= 0) break;
    answer.append(buffer, std::size_t(got));
  }
  close(socket);
  return answer;
}

StudioServer::Answer StudioServer::parsed(const std::string& bytes) {
  Answer answer;
  const std::size_t end = bytes.find("\r\n\r\n");
  if (!bytes.starts_with("HTTP/1.1 ") || end == bytes.npos) return answer;
  answer.status = std::atoi(bytes.c_str() + 9);
  answer.headers = bytes.substr(0, end);
  answer.body = bytes.substr(end + 4);
  return answer;
}

namespace {

std::string head(const StudioServer& server, const std::string& line) {
  return line + " HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(server.port()) + "\r\nX-Ngs-Token: " + server.token() +
         "\r\nConnection: close\r\n";
}

}  // namespace

StudioServer::Answer StudioServer::get(const std::string& path) const {
  return parsed(send(head(*this, "GET " + path) + "\r\n", 60));
}

StudioServer::Answer StudioServer::post(const std::string& path, const std::string& body) const {
  return parsed(send(head(*this, "POST " + path) + "Content-Type: application/json\r\nContent-Length: " +
                         std::to_string(body.size()) + "\r\n\r\n" + body,
                     60));
}

int StudioServer::quit() {
  post("/api/quit", "{}");
  int status = 0;
  waitpid(process_, &status, 0);
  process_ = 0;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace ngs::test
