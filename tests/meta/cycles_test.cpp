// No units of libngs/ and tools/ include each other.
#include <doctest/doctest.h>

#include "support/include_graph.h"
#include "support/source_tree.h"

namespace ngs {
namespace {

using test::SourceFile;

using Cycles = std::vector<std::vector<std::string>>;

Cycles cycles(const std::vector<SourceFile>& files) { return test::include_cycles(test::include_graph(files)); }

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

TEST_CASE("there are no include cycles between units") {
  std::vector<std::string> found;
  for (const std::vector<std::string>& cycle : cycles(test::code_files())) {
    std::string units;
    for (const std::string& unit : cycle) units += unit + " ";
    found.push_back(units);
  }
  CHECK(test::listed(found) == "");
}

}  // namespace ngs
