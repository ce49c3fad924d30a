#pragma once
// Splits argv into flags with values and positionals. CLI11 does nothing but this: every value is collected as text,
// one per occurrence, because a CLI11 list option would consume the positionals after it. All checks and messages are
// our own.
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace ngs::cli {

using Texts = std::vector<std::string>;

class Splitter {
 public:
  Splitter();
  ~Splitter();

  /// Adds a flag with a value. `flags` ("-o,--output") is its key below.
  void value(const std::string& flags);
  /// Adds a flag without a value, or with "=false". "--fast,!--no-fast": the second spelling means false.
  void flag(const std::string& flags);

  /// Returns the positionals of a command line. Throws kUsage for an unknown flag, or for a flag without its value.
  Texts split(Texts words);

  const Texts& operator[](const std::string& flags) const { return texts_.at(flags); }
  bool has(const std::string& flags) const { return !texts_.at(flags).empty(); }

 private:
  void register_names(const std::string& flags);
  [[noreturn]] void refuse(const std::string& word) const;

  struct App;
  std::unique_ptr<App> app_;
  std::map<std::string, Texts> texts_;
  Texts known_;
};

}  // namespace ngs::cli
