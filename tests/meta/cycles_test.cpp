// No units of libngs/ and tools/ include each other.
#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "support/source_tree.h"

// The include graph of the code, by unit. x.h, x.cpp and x.cu of one folder are one unit, "libngs/ngs/ops/rbf", with
// the includes of all of them.
namespace ngs::test {
namespace {

/// unit -> the other units that it includes.
using IncludeGraph = std::map<std::string, std::set<std::string>>;

namespace fs = std::filesystem;

std::string unit_of(const std::string& path) { return fs::path(path).replace_extension().generic_string(); }

std::vector<std::string> quoted_includes(const std::string& text) {
  static const std::regex include("#\\s*include\\s*\"([^\"]+)\"");
  std::vector<std::string> headers;
  for (std::sregex_iterator at(text.begin(), text.end(), include), end; at != end; ++at) headers.push_back((*at)[1]);
  return headers;
}

/// Every unit of `files` is a key. Includes are resolved as in the build: relative to the including file, to libngs/
/// and to tools/. Headers that are not in `files` are ignored.
IncludeGraph include_graph(const std::vector<SourceFile>& files) {
  std::set<std::string> paths;
  for (const SourceFile& file : files) paths.insert(file.path);
  IncludeGraph graph;
  for (const SourceFile& file : files) {
    const fs::path folder = fs::path(file.path).parent_path();
    std::set<std::string>& included = graph[unit_of(file.path)];
    for (const std::string& header : quoted_includes(file.text))
      for (const fs::path& from : {folder, fs::path("libngs"), fs::path("tools")}) {
        const std::string path = (from / header).lexically_normal().generic_string();
        if (paths.count(path) == 0) continue;
        if (unit_of(path) != unit_of(file.path)) included.insert(unit_of(path));
        break;
      }
  }
  return graph;
}

/// The units that include each other, directly or indirectly, and those on a path between two such: what is left after
/// units that include none of the others, or that none of the others includes, are removed one after the other.
std::vector<std::string> units_in_cycles(const std::vector<SourceFile>& files) {
  IncludeGraph left = include_graph(files);
  const auto included = [&](const std::string& unit) {
    return std::ranges::any_of(left, [&](const auto& other) { return other.second.contains(unit); });
  };
  const auto includes = [&](const auto& entry) {
    return std::ranges::any_of(entry.second, [&](const std::string& unit) { return left.contains(unit); });
  };
  const auto is_outside = [&](const auto& entry) { return !includes(entry) || !included(entry.first); };
  while (std::erase_if(left, is_outside) > 0) continue;
  std::vector<std::string> units;
  for (const auto& [unit, others] : left) units.push_back(unit);
  return units;
}

}  // namespace

TEST_CASE("units that include each other are found, in whatever way they name their headers") {
  const SourceFile a{"libngs/ngs/x/a.h", "#include \"ngs/x/b.h\"\n"}, b{"libngs/ngs/x/b.h", "#include <vector>\n"},
      b_source{"libngs/ngs/x/b.cpp", "#include \"ngs/x/b.h\"\n#  include \"ngs/y/c.cuh\"\n"},
      c{"libngs/ngs/y/c.cuh", "#include \"ngs/x/a.h\"\n"}, top{"libngs/ngs/y/top.h", "#include \"ngs/x/a.h\"\n"};
  CHECK(units_in_cycles({a, b, c, top}).empty());
  CHECK(units_in_cycles({a, b, b_source, top}).empty());
  CHECK(listed(units_in_cycles({a, b, b_source, c, top})) == "libngs/ngs/x/a\nlibngs/ngs/x/b\nlibngs/ngs/y/c\n");

  const SourceFile local{"tools/ngs-x/main.cpp", "#include \"part.h\"\n"}, main{"tools/ngs-x/main.h", ""},
      part{"tools/ngs-x/part.h", "#include \"shared/tool.h\"\n#include \"part.h\"\n"},
      tool{"tools/shared/tool.h", "#include \"../ngs-x/main.h\"\n"};
  CHECK(units_in_cycles({local, main, part}).empty());
  CHECK(listed(units_in_cycles({local, main, part, tool})) ==
        "tools/ngs-x/main\ntools/ngs-x/part\ntools/shared/tool\n");
}

TEST_CASE("no units include each other") { CHECK(listed(units_in_cycles(code_files())) == ""); }

}  // namespace ngs::test
