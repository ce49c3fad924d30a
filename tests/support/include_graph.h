#pragma once
// The include graph of the code, by unit. x.h, x.cpp and x.cu of one folder are one unit, "libngs/ngs/ops/rbf", with
// the includes of all of them.
#include <map>
#include <set>
#include <string>
#include <vector>

#include "support/source_tree.h"

namespace ngs::test {

/// unit -> the other units that it includes; every unit of `files` is a key. Includes are resolved as in the build:
/// relative to the including file, to libngs/ and to tools/. Headers that are not in `files` are ignored.
using IncludeGraph = std::map<std::string, std::set<std::string>>;
IncludeGraph include_graph(const std::vector<SourceFile>& files);

/// The strongly connected components with more than one unit: units that include each other, directly or indirectly.
/// Each component is sorted, and so is the list.
std::vector<std::vector<std::string>> include_cycles(const IncludeGraph& graph);

}  // namespace ngs::test
