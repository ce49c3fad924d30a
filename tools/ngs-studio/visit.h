#pragma once
// Recording and replay of a session as JSON lines: {"path": "/api/strokes", "body": {...}}.
#include <functional>
#include <mutex>
#include <string>

#include "studio.h"

namespace ngs::studio {

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
