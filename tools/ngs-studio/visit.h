#pragma once
// A visit as JSON lines, {"path": "/api/strokes", "body": {...}}: written down as it is made, and run again.
#include <functional>
#include <mutex>
#include <string>

#include "studio.h"

namespace ngs::studio {

/// Passes requests on and keeps those that succeeded, frames included.
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

/// Makes the requests of a file one after the other, and waits for each job to end. Error (kBadInput, or the code of
/// what failed) that names the line. Returns the number of requests; stops early where it is asked to.
std::size_t replay(Studio& studio, const std::string& path, const ReplayControl& control);

}  // namespace ngs::studio
