#include "shared/cli/splitter.h"

#include <CLI/CLI.hpp>
#include <algorithm>

#include "ngs/core/error.h"
#include "ngs/options/near_matches.h"

namespace ngs::cli {

struct Splitter::App : CLI::App {};

Splitter::Splitter() : app_(std::make_unique<App>()) {
  app_->set_help_flag();
  app_->allow_extras();
}
Splitter::~Splitter() = default;

void Splitter::value(const std::string& flags) {
  app_->add_option(flags, texts_[flags])->take_all()->expected(1)->allow_extra_args(false);
  register_names(flags);
}

void Splitter::flag(const std::string& flags) {
  app_->add_flag(flags, texts_[flags])->take_all();
  register_names(flags);
}

Texts Splitter::split(Texts words) {
  const auto end_of_flags = std::find(words.begin(), words.end(), "--");
  Texts plain(end_of_flags == words.end() ? end_of_flags : end_of_flags + 1, words.end());
  words.erase(end_of_flags, words.end());
  std::reverse(words.begin(), words.end());  // CLI11 reads them from the back
  try {
    app_->parse(words);
  } catch (const CLI::ArgumentMismatch& e) {  // the message begins with the flag
    const std::string message = e.what();
    throw Error(ErrorCode::kUsage, message.substr(0, message.find(':')) + ": no value given, expected one",
                "see --help");
  } catch (const CLI::ParseError& e) {
    throw Error(ErrorCode::kUsage, e.what(), "see --help");
  }
  Texts rest;
  for (const std::string& word : app_->remaining()) {
    if (word.size() > 1 && word[0] == '-') refuse(word.substr(0, word.find('=')));
    rest.push_back(word);
  }
  rest.insert(rest.end(), plain.begin(), plain.end());
  return rest;
}

void Splitter::register_names(const std::string& flags) {
  for (std::size_t begin = 0; begin < flags.size();) {
    const std::size_t end = std::min(flags.find(',', begin), flags.size());
    known_.push_back(flags.substr(begin, end - begin));
    if (known_.back()[0] == '!') known_.back().erase(0, 1);
    begin = end + 1;
  }
}

void Splitter::refuse(const std::string& word) const {
  const bool near = !near_matches(word, known_).empty();
  throw Error(ErrorCode::kUsage, "unknown flag '" + word + "'", near ? suggestion(word, known_) : "see --help");
}

}  // namespace ngs::cli
