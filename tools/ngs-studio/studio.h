#pragma once
// The studio for one model: maps requests to responses (data-schema/studio-protocol.md). Independent of HTTP.
#include <functional>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>

#include "ngs/backend/exec.h"
#include "requests.h"
#include "state_folder.h"

namespace ngs::studio {

/// What `work` returns, or the error response for what it throws. Never throws.
Reply reply_of(const std::function<Reply()>& work);

class Studio {
 public:
  /// Reads the model. Throws the errors of the readers.
  Studio(const Exec& exec, StudioPlace place);
  ~Studio();
  Studio(const Studio&) = delete;
  Studio& operator=(const Studio&) = delete;

  /// Never throws; thread-safe.
  Reply answer(const std::string& method, const std::string& path, const std::string& body);
  /// True after POST /api/quit.
  bool has_quit() const;
  nlohmann::ordered_json log() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Recording and replay of a session as JSON lines: {"path": "/api/strokes", "body": {...}}.

/// Forwards requests and records those that succeeded, including frames.
class Recorder {
 public:
  explicit Recorder(Studio& studio) : studio_(studio) {}
  Reply answer(const std::string& method, const std::string& path, const std::string& body);
  std::string lines() const;

 private:
  Studio& studio_;
  mutable std::mutex mutex_;
  std::string lines_;
};

struct ReplayControl {
  std::function<bool()> stop;
  std::function<void(std::int64_t done, std::int64_t total)> progress;
};

/// Sends the requests of a file in order and waits for the end of each job. Returns the number of requests; stops
/// early when control.stop() is true. Errors name the line; kBadInput, or the code of the failed step.
std::size_t replay(Studio& studio, const std::string& path, const ReplayControl& control);

}  // namespace ngs::studio
