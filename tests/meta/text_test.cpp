// Headers begin with a guard and a contract; no marks of unfinished work, no paths of one machine.
#include <doctest/doctest.h>

#include <regex>
#include <sstream>

#include "support/process.h"
#include "support/skip.h"
#include "support/source_tree.h"

namespace ngs {
namespace {

using test::SourceFile;

}  // namespace

TEST_CASE("headers begin with #pragma once and a comment") {
  std::vector<std::string> offenders;
  for (const SourceFile& file : test::source_files({"libngs", "tools", "tests"}, {".h", ".cuh"}))
    if (file.text.rfind("#pragma once\n//", 0) != 0) offenders.push_back(file.path);
  CHECK(test::listed(offenders) == "");
}

TEST_CASE("no file contains a mark of unfinished work or an absolute home path") {
  // the words are split so that this file does not match
  const std::regex marks(
      "\\b(TO"
      "DO|FIX"
      "ME|XX"
      "X|HA"
      "CK)\\b");
  const std::regex machine(
      "[\"' =](/ho"
      "me/|/ro"
      "ot/|/wo"
      "rk/|/Use"
      "rs/)[a-z]");
  std::vector<std::string> offenders;
  for (const SourceFile& file :
       test::source_files({"libngs", "tools", "tests", "pipelines", "docs"},
                          {".h", ".cpp", ".cu", ".cuh", ".sh", ".mk", ".md", ".cmake", "CMakeLists.txt"})) {
    std::smatch match;
    if (std::regex_search(file.text, match, marks) || std::regex_search(file.text, match, machine))
      offenders.push_back(file.path + ": " + match[0].str());
  }
  CHECK(test::listed(offenders) == "");
}

// The tree is formatted by .clang-format, so that running the formatter shows only own changes.

namespace {

using Words = std::vector<std::string>;

/// Other versions break lines differently.
constexpr const char* kVersion = "version 14.";

std::vector<test::SourceFile> all_code() {
  return test::source_files({"libngs", "tools", "tests"}, {".h", ".cpp", ".cu", ".cuh"});
}

/// The words of a comment line; empty for a line of code. Slashes are skipped.
Words comment_words(const std::string& line) {
  std::istringstream words(line);
  Words all;
  for (std::string word; words >> word;) all.push_back(word);
  if (all.empty() || (all[0] != "//" && all[0] != "///")) return {};
  return {all.begin() + 1, all.end()};
}

/// Line numbers where the formatter has reflowed a table: a single word in the middle of a sentence, below a full line
/// and above another comment line.
std::vector<std::size_t> reflowed(const std::string& text) {
  constexpr std::size_t kFullLine = 100;
  std::istringstream in(text);
  Words lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  std::vector<std::size_t> found;
  for (std::size_t i = 1; i + 1 < lines.size(); ++i) {
    const Words words = comment_words(lines[i]);
    if (words.size() == 1 && std::string(".:;!?)").find(words[0].back()) == std::string::npos &&
        !comment_words(lines[i - 1]).empty() && lines[i - 1].size() > kFullLine && !comment_words(lines[i + 1]).empty())
      found.push_back(i + 1);
  }
  return found;
}

}  // namespace

TEST_CASE("every source file is formatted as .clang-format requires") {
  const test::ProcessResult version = test::run_command({"/usr/bin/env", "clang-format", "--version"});
  if (version.exit_code != 0) return test::skip("clang-format is not installed");
  if (version.out.find(kVersion) == std::string::npos)
    return test::skip("expected clang-format " + std::string(kVersion) + "x, found " + version.out);
  test::ProcessSpec check{.argv = {"/usr/bin/env", "clang-format", "--dry-run", "--Werror"}, .folder = NGS_SOURCE_DIR};
  for (const test::SourceFile& file : all_code()) check.argv.push_back(file.path);
  test::succeeded(test::run_process(check));
}

TEST_CASE("no table in a comment was reflowed by the formatter") {
  Words all;
  for (const test::SourceFile& file : all_code())
    for (const std::size_t line : reflowed(file.text))
      all.push_back(file.path + ":" + std::to_string(line) + ": put the table between // clang-format off and on");
  CHECK(test::listed(all) == "");

  const std::string full = "//   strict      " + std::string(90, 'x') + "\n";
  CHECK(reflowed(full + "//   all\n//               float\n") == std::vector<std::size_t>{2});
  CHECK(reflowed(full + "//   all.\n//               float\n").empty());
  CHECK(reflowed(full + "//   all\nint x;\n").empty());
}

}  // namespace ngs
