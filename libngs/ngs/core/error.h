#pragma once
// The one exception type of the library. The numbers are exit codes of the tools.
#include <stdexcept>
#include <string>
#include <string_view>

namespace ngs {

enum class ErrorCode : int {
  kUsage = 2,         // an invalid flag, option value or options file
  kBadInput = 3,      // an input is unreadable, truncated or invalid
  kInconsistent = 4,  // inputs contradict each other (poses, PLY, masks)
  kNothingFound = 5,  // empty boundary or object
  kNumeric = 6,       // a non-finite value crossed a stage boundary
  kEnvironment = 8,   // cannot write, no memory, no such device
};

/// `what()` reads "<object>: <found>, expected <what>"; `remedy()` is the hint, often a command.
class Error : public std::runtime_error {
 public:
  Error(ErrorCode code, const std::string& what_failed, std::string remedy = {})
      : std::runtime_error(what_failed), code_(code), remedy_(std::move(remedy)) {}
  ErrorCode code() const noexcept { return code_; }
  const std::string& remedy() const noexcept { return remedy_; }

 private:
  ErrorCode code_;
  std::string remedy_;
};

/// A device has too little memory. The arguments of the op that failed are unchanged, and its memory is released.
class OutOfDeviceMemory : public Error {
 public:
  explicit OutOfDeviceMemory(const std::string& what)
      : Error(ErrorCode::kEnvironment, what, "use --device cpu, or a smaller image scale") {}
};

/// Runs `body` and rethrows an Error from it with "`context`: " before the message. Use it once per layer.
template <class Body>
auto with_context(std::string_view context, Body&& body) -> decltype(body()) {
  try {
    return body();
  } catch (const OutOfDeviceMemory& e) {
    throw OutOfDeviceMemory(std::string(context) + ": " + e.what());
  } catch (const Error& e) {
    throw Error(e.code(), std::string(context) + ": " + e.what(), e.remedy());
  }
}

}  // namespace ngs
