// Limits on line width and file length; no marks of unfinished work.
#include <doctest/doctest.h>

#include <regex>
#include <sstream>

#include "support/source_tree.h"

namespace ngs {
namespace {

using test::SourceFile;

constexpr int kFileLines = 400, kMainLines = 110, kLineCharacters = 120;

int lines(const std::string& text) { return int(std::count(text.begin(), text.end(), '\n')); }

std::vector<SourceFile> all_code() {
  return test::source_files({"libngs", "tools", "tests"}, {".h", ".cpp", ".cu", ".cuh"});
}

int characters(const std::string& utf8) {
  return int(std::count_if(utf8.begin(), utf8.end(), [](char c) { return (c & 0xc0) != 0x80; }));
}

/// Adds "PATH:LINE" of lines that are too wide. Raw strings, such as pages, are exempt.
void add_wide_lines(const SourceFile& file, std::vector<std::string>& offenders) {
  std::istringstream text(file.text);
  std::string line;
  bool raw = false;
  for (int number = 1; std::getline(text, line); ++number) {
    const bool was_raw = raw;
    if (line.find("R\"") != std::string::npos) raw = true;
    const bool any_raw = was_raw || raw;
    if (raw && std::regex_search(line, std::regex("\\)[a-z]*\""))) raw = false;
    if (!any_raw && characters(line) > kLineCharacters) offenders.push_back(file.path + ":" + std::to_string(number));
  }
}

}  // namespace

TEST_CASE("no source line has more than 120 characters") {
  std::vector<std::string> offenders;
  for (const SourceFile& file : all_code()) add_wide_lines(file, offenders);
  CHECK(test::listed(offenders) == "");

  std::vector<std::string> found;
  add_wide_lines({"wide.h", "int x;\n//" + std::string(119, '-') + "\n"}, found);
  CHECK(found == std::vector<std::string>{"wide.h:2"});
}

TEST_CASE("no source file has more than 400 lines, no main.cpp of a tool more than 110") {
  std::vector<std::string> offenders;
  for (const SourceFile& file : all_code()) {
    const bool is_main = file.in("tools") && file.ends_with("/main.cpp");
    const int budget = is_main ? kMainLines : kFileLines;
    if (lines(file.text) > budget)
      offenders.push_back(file.path + ": " + std::to_string(lines(file.text)) + " lines, expected at most " +
                          std::to_string(budget));
  }
  CHECK(test::listed(offenders) == "");
}

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

}  // namespace ngs
