// Headers begin with a guard and a contract; no marks of unfinished work, no paths of one machine.
#include <doctest/doctest.h>

#include <regex>

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

}  // namespace ngs
