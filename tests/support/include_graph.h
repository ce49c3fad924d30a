#pragma once
// Which unit of the code includes which. x.h, x.cpp and x.cu of one folder are one unit, "libngs/ngs/ops/rbf": what one
// of them needs all of them need.
#include <map>
#include <set>
#include <string>
#include <vector>

#include "support/source_tree.h"

namespace ngs::test {

/// unit -> the other units that it includes; every unit of `files` is a key. Includes are found relative to the
/// including file, to libngs/ and to tools/, as the build finds them; headers that are none of `files` do not count.
using IncludeGraph = std::map<std::string, std::set<std::string>>;
IncludeGraph include_graph(const std::vector<SourceFile>& files);

/// The largest sets of units that include each other, directly or through others: strongly connected components of more
/// than one unit. Each is sorted, and so is the list.
std::vector<std::vector<std::string>> include_cycles(const IncludeGraph& graph);

}  // namespace ngs::test
