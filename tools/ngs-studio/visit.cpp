#include <chrono>
#include <fstream>
#include <thread>

#include "ngs/core/error.h"
#include "ngs/options/strict_json.h"
#include "requests.h"
#include "studio.h"

namespace ngs::studio {
namespace {

constexpr std::uintmax_t kMaxBytes = 256u << 20;

std::vector<std::string> lines_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::vector<std::string> lines;
  std::uintmax_t bytes = 0;
  for (std::string line; std::getline(file, line);) {
    bytes += line.size() + 1;
    if (bytes > kMaxBytes)
      throw Error(ErrorCode::kBadInput, path + ": larger than 256 MiB, expected the requests of a session");
    if (!line.empty()) lines.push_back(std::move(line));
  }
  return lines;
}

/// Refine and Export run on after their response.
void wait_for_job(Studio& studio, const std::string& where, const ReplayControl& control) {
  for (;;) {
    const nlohmann::json job = nlohmann::json::parse(studio.answer("GET", "/api/job", "").body);
    if (!job.is_object() || job.at("state") == "done") return;
    if (job.at("state") != "running")
      throw Error(ErrorCode::kBadInput,
                  where + ": " + job.at("kind").get<std::string>() + " " + job.at("state").get<std::string>() +
                      (job.at("error").is_string() ? ": " + job.at("error").get<std::string>() : ""));
    if (control.stop()) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

}  // namespace

Reply Recorder::answer(const std::string& method, const std::string& path, const std::string& body) {
  Reply reply = studio_.answer(method, path, body);
  if (method != "POST" || reply.status >= 400 || path == "/api/quit" || path == "/api/cancel" ||
      path == "/api/download")
    return reply;
  const std::string line = Json{{"path", path}, {"body", parse_body(body)}}.dump() + "\n";
  const std::lock_guard lock(mutex_);
  lines_ += line;
  return reply;
}

std::string Recorder::lines() const {
  const std::lock_guard lock(mutex_);
  return lines_;
}

std::size_t replay(Studio& studio, const std::string& path, const ReplayControl& control) {
  const std::vector<std::string> lines = lines_of(path);
  std::size_t done = 0;
  for (; done < lines.size() && !control.stop(); ++done) {
    const std::string where = path + ": line " + std::to_string(done + 1);
    const auto request = parse_strict_json<nlohmann::json>(lines[done], where, ErrorCode::kBadInput);
    if (!request.is_object() || request.size() != 2 || !request.contains("path") || !request.at("path").is_string() ||
        !request.contains("body") || !request.at("body").is_object())
      throw Error(ErrorCode::kBadInput, where + ": not a request, expected {\"path\": TEXT, \"body\": {...}}",
                  "record one with --record");
    const Reply reply = studio.answer("POST", request.at("path").get<std::string>(), request.at("body").dump());
    if (reply.status >= 400) {
      const nlohmann::json error = nlohmann::json::parse(reply.body).at("error");
      throw Error(ErrorCode::kBadInput,
                  where + ": " + error.at("object").get<std::string>() + ": " + error.at("found").get<std::string>() +
                      ", expected " + error.at("expected").get<std::string>(),
                  error.at("remedy").get<std::string>());
    }
    wait_for_job(studio, where, control);
    control.progress(std::int64_t(done) + 1, std::int64_t(lines.size()));
  }
  return done;
}

}  // namespace ngs::studio
