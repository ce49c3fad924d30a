// Measures of code structure: include cycles, folder sizes, file lengths. They are functions of a list of files and are
// tested on small examples.
#include <doctest/doctest.h>

#include "support/include_graph.h"
#include "support/source_tree.h"

namespace ngs {
namespace {

using test::SourceFile;

using Cycles = std::vector<std::vector<std::string>>;

Cycles cycles(const std::vector<SourceFile>& files) { return test::include_cycles(test::include_graph(files)); }

/// Number of source files directly in each folder.
std::map<std::string, int> folder_sizes(const std::vector<SourceFile>& files) {
  std::map<std::string, int> sizes;
  for (const SourceFile& file : files) ++sizes[file.path.substr(0, file.path.rfind('/'))];
  return sizes;
}

int line_count(const SourceFile& file) { return int(std::count(file.text.begin(), file.text.end(), '\n')); }

}  // namespace

TEST_CASE("include cycles: finds exactly the units that include each other") {
  const SourceFile a{"libngs/ngs/x/a.h", "#include \"ngs/x/b.h\"\n"}, b{"libngs/ngs/x/b.h", "#include <vector>\n"},
      b_source{"libngs/ngs/x/b.cpp", "#include \"ngs/x/b.h\"\n#  include \"ngs/y/c.h\"\n"},
      c{"libngs/ngs/y/c.h", "#include \"ngs/x/a.h\"\n"}, top{"libngs/ngs/y/top.h", "#include \"ngs/x/a.h\"\n"};
  CHECK(cycles({a, b, c, top}).empty());
  CHECK(cycles({a, b, b_source, top}).empty());
  CHECK(cycles({a, b, b_source, c, top}) == Cycles{{"libngs/ngs/x/a", "libngs/ngs/x/b", "libngs/ngs/y/c"}});
}

TEST_CASE("includes are resolved from the including folder, libngs/ and tools/; .cu and .cuh belong to their unit") {
  const SourceFile local{"tools/ngs-x/main.cpp", "#include \"part.h\"\n"},
      back{"tools/ngs-x/part.h", "#include \"shared/tool.h\"\n"},
      tool{"tools/shared/tool.h", "#include \"../ngs-x/main.h\"\n"}, main{"tools/ngs-x/main.h", ""},
      kernel{"libngs/ngs/z/k.cu", "#include \"ngs/z/l.cuh\"\n"},
      layout{"libngs/ngs/z/l.cuh", "#include \"ngs/z/k.h\"\n"}, header{"libngs/ngs/z/k.h", ""};
  const test::IncludeGraph graph = test::include_graph({local, back, tool, main, kernel, layout, header});
  CHECK(graph.size() == 5);
  CHECK(graph.at("tools/ngs-x/main") == std::set<std::string>{"tools/ngs-x/part"});
  CHECK(graph.at("tools/ngs-x/part") == std::set<std::string>{"tools/shared/tool"});
  CHECK(test::include_cycles(graph) ==
        Cycles{{"libngs/ngs/z/k", "libngs/ngs/z/l"}, {"tools/ngs-x/main", "tools/ngs-x/part", "tools/shared/tool"}});
}

TEST_CASE("disjoint cycles are separate, and a file that includes itself is no cycle") {
  const auto pair = [](const std::string& folder) {
    return std::vector<SourceFile>{{folder + "/a.h", "#include \"b.h\"\n"}, {folder + "/b.h", "#include \"a.h\"\n"}};
  };
  std::vector<SourceFile> files = pair("libngs/ngs/x");
  const std::vector<SourceFile> more = pair("tools/y");
  files.insert(files.end(), more.begin(), more.end());
  CHECK(cycles(files) == Cycles{{"libngs/ngs/x/a", "libngs/ngs/x/b"}, {"tools/y/a", "tools/y/b"}});
  CHECK(cycles({{"tools/y/self.h", "#include \"self.h\"\n"}}).empty());
}

TEST_CASE("folder sizes count only files directly in a folder") {
  const std::vector<SourceFile> files = {{"tools/x/a.h", ""}, {"tools/x/b.h", ""}, {"tools/x/deeper/c.h", ""}};
  CHECK(folder_sizes(files) == std::map<std::string, int>{{"tools/x", 2}, {"tools/x/deeper", 1}});
  CHECK(line_count({"tools/x/a.h", "one\ntwo\n"}) == 2);
}

TEST_CASE("the include graph of this tree contains all units and edges from tools to the library") {
  const test::IncludeGraph graph = test::include_graph(test::code_files());
  CHECK(graph.size() > 300);
  int edges = 0, into_library = 0;
  for (const auto& [unit, includes] : graph)
    for (const std::string& other : includes)
      ++edges, into_library += unit.starts_with("tools/") && other.starts_with("libngs/");
  CHECK(edges > 1000);
  CHECK(into_library > 100);
}

}  // namespace ngs
