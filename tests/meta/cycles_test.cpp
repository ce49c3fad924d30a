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

/// Tarjan's algorithm.
class Components {
 public:
  explicit Components(const IncludeGraph& graph) : graph_(graph) {
    for (const auto& [unit, includes] : graph)
      if (order_.count(unit) == 0) visit(unit);
  }
  std::vector<std::vector<std::string>> take() && { return std::move(found_); }

 private:
  int visit(const std::string& unit) {
    const int order = order_[unit] = int(order_.size());
    int lowest = order;
    stack_.push_back(unit);
    for (const std::string& next : graph_.at(unit)) {
      if (order_.count(next) == 0)
        lowest = std::min(lowest, visit(next));
      else if (std::find(stack_.begin(), stack_.end(), next) != stack_.end())
        lowest = std::min(lowest, order_.at(next));
    }
    if (lowest == order) pop_component(unit);
    return lowest;
  }
  void pop_component(const std::string& root) {
    const auto first = std::find(stack_.begin(), stack_.end(), root);
    std::vector<std::string> component(first, stack_.end());
    stack_.erase(first, stack_.end());
    std::sort(component.begin(), component.end());
    if (component.size() > 1) found_.push_back(std::move(component));
  }

  const IncludeGraph& graph_;
  std::map<std::string, int> order_;  // of the first visit
  std::vector<std::string> stack_;
  std::vector<std::vector<std::string>> found_;
};

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

/// The strongly connected components with more than one unit: units that include each other, directly or indirectly.
/// Each component is sorted, and so is the list.
std::vector<std::vector<std::string>> include_cycles(const IncludeGraph& graph) {
  std::vector<std::vector<std::string>> cycles = Components(graph).take();
  std::sort(cycles.begin(), cycles.end());
  return cycles;
}

}  // namespace
}  // namespace ngs::test

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
