#pragma once
// argv cut into flags with their values, and words. CLI11 only splits here: every value is collected as text, one per
// occurrence (it would otherwise let a list option swallow the positionals behind it), and all checks and messages are
// ours.
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

  /// A flag that takes a value. `flags` ("-o,--output") is its key below.
  void value(const std::string& flags);
  /// One that takes none, or "=false". "--fast,!--no-fast": the second spelling means false.
  void flag(const std::string& flags);

  /// Of the words of a command line, those that belong to no flag. Error(kUsage) for an unknown flag, or one without
  /// its value.
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
