// Checks references: files named in paper.md, contributing.md and the decisions, links between documents, and
// sections of paper.md cited in comments.
#include <doctest/doctest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <regex>
#include <set>

#include "support/source_tree.h"

namespace ngs {
namespace {

namespace fs = std::filesystem;
using test::SourceFile;

std::vector<std::string> captures(const std::string& text, const std::regex& pattern) {
  std::vector<std::string> found;
  for (std::sregex_iterator at(text.begin(), text.end(), pattern), end; at != end; ++at) found.push_back((*at)[1]);
  return found;
}

/// Paths in backticks: `folder/file.ext`, `folder/`, `tests/suite/name_test`. Text with a space, '*', '{', '|' or '=',
/// such as commands and patterns, is not a path.
std::vector<std::string> named_paths(const std::string& text) {
  static const std::regex path("`((?:[a-z][a-z0-9_.-]*/)+[A-Za-z0-9_.-]*)`");
  return captures(text, path);
}

struct Link {
  std::string file, anchor;  // empty file: the same document; empty anchor: none
};

/// Relative links, [text](file.md#anchor).
std::vector<Link> links_of(const std::string& text) {
  static const std::regex link("\\]\\(([^)#:]*)(?:#([^)]*))?\\)");
  std::vector<Link> found;
  for (std::sregex_iterator at(text.begin(), text.end(), link), end; at != end; ++at)
    found.push_back({(*at)[1], (*at)[2]});
  return found;
}

/// Anchor of a heading: lower-case letters, digits, '-' and '_', with '-' for every space.
std::string anchor_of(const std::string& heading) {
  std::string anchor;
  for (const char c : heading) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_') anchor += char(std::tolower(c));
    if (c == ' ') anchor += '-';
  }
  return anchor;
}

bool has_anchor(const std::string& text, const std::string& anchor) {
  if (text.find("<a id=\"" + anchor + "\"></a>") != text.npos) return true;
  static const std::regex heading("(?:^|\n)#+ ([^\n]*)");
  const std::vector<std::string> found = captures(text, heading);
  return std::any_of(found.begin(), found.end(), [&](const std::string& h) { return anchor_of(h) == anchor; });
}

/// Source paths are relative to libngs/ngs, other paths to the top folder; names of tests omit ".cpp".
bool names_a_file(const std::string& path) {
  const fs::path top = NGS_SOURCE_DIR;
  return fs::exists(top / "libngs/ngs" / path) || fs::exists(top / path) || fs::exists(top / (path + ".cpp"));
}

std::vector<std::string> broken_paths(const SourceFile& document) {
  std::vector<std::string> offenders;
  for (const std::string& path : named_paths(document.text))
    if (!names_a_file(path) && path.find("NAME") == std::string::npos) offenders.push_back(document.path + ": " + path);
  return offenders;
}

std::vector<std::string> broken_links(const SourceFile& document) {
  const fs::path folder = (fs::path(NGS_SOURCE_DIR) / document.path).parent_path();
  std::vector<std::string> offenders;
  for (const auto& [file, anchor] : links_of(document.text)) {
    const bool file_exists = file.empty() || fs::exists(folder / file);
    const bool heading_exists =
        anchor.empty() || has_anchor(file.empty() ? document.text : test::read_bytes((folder / file).string()), anchor);
    if (!file_exists || !heading_exists)
      offenders.push_back(document.path + ": " + file + (heading_exists ? "" : "#" + anchor));
  }
  return offenders;
}

/// Section numbers of headings: "5.10" for "### 5.10  Contour refinement".
std::set<std::string> sections_of(const SourceFile& paper) {
  static const std::regex heading("(?:^|\n)##+ ([0-9.]+)  ");
  const std::vector<std::string> found = captures(paper.text, heading);
  return {found.begin(), found.end()};
}

std::vector<std::string> broken_sections(const SourceFile& file, const std::set<std::string>& sections) {
  static const std::regex section("§([0-9]+(?:\\.[0-9]+)?)");
  std::vector<std::string> offenders;
  for (const std::string& number : captures(file.text, section))
    if (sections.count(number) == 0) offenders.push_back(file.path + ": §" + number);
  return offenders;
}

std::vector<SourceFile> documents() {
  std::vector<SourceFile> files = test::source_files({"docs", "tools", "pipelines", "data-schema", "tests"}, {".md"});
  for (const char* name : {"README.md", "BENCHMARKS.md"}) files.push_back(test::source_file(name));
  return files;
}

bool names_paths(const SourceFile& document) {
  return document.path == "docs/paper.md" || document.path == "docs/contributing.md" || document.in("docs/decisions");
}

void append(std::vector<std::string>& to, const std::vector<std::string>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

}  // namespace

TEST_CASE("every path named in paper.md, contributing.md or a decision note exists") {
  std::vector<std::string> offenders;
  for (const SourceFile& document : documents())
    if (names_paths(document)) append(offenders, broken_paths(document));
  CHECK(test::listed(offenders) == "");

  const SourceFile broken{"a.md", "`ops/none_kernels.h`, `core/error.h`, `tests/meta/paper_test`, `--a x/y`, `W1 / W`"};
  CHECK(broken_paths(broken) == std::vector<std::string>{"a.md: ops/none_kernels.h"});
}

TEST_CASE("every relative link points to an existing file and heading") {
  std::vector<std::string> offenders;
  for (const SourceFile& document : documents()) append(offenders, broken_links(document));
  CHECK(test::listed(offenders) == "");

  const SourceFile broken{"docs/a.md",
                          "## A b: `c`\n[a](paper.md#4--readings) [b](#a-b-c) [d](https://e.org) [e](#007) "
                          "[f](decisions/none.md) [g](paper.md#44--none) [h](#a)\n## <a id=\"007\"></a>007 E"};
  CHECK(broken_links(broken) ==
        std::vector<std::string>{"docs/a.md: decisions/none.md", "docs/a.md: paper.md#44--none", "docs/a.md: #a"});
}

TEST_CASE("every section cited in a comment or document exists in paper.md") {
  const std::set<std::string> sections = sections_of(test::source_file("docs/paper.md"));
  std::vector<SourceFile> files = test::source_files({"libngs", "tools", "tests"}, {".h", ".cpp", ".cu", ".cuh"});
  for (SourceFile& document : documents()) files.push_back(std::move(document));
  std::vector<std::string> offenders;
  for (const SourceFile& file : files)
    if (file.path != "tests/meta/paper_test.cpp") append(offenders, broken_sections(file, sections));
  CHECK(test::listed(offenders) == "");

  CHECK(broken_sections({"a.h", "// paper.md §5.1 and §5.99"}, sections) == std::vector<std::string>{"a.h: §5.99"});
}

}  // namespace ngs
