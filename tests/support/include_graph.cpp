#include "support/include_graph.h"

#include <algorithm>
#include <regex>

namespace ngs::test {
namespace {

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

}  // namespace

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

std::vector<std::vector<std::string>> include_cycles(const IncludeGraph& graph) {
  std::vector<std::vector<std::string>> cycles = Components(graph).take();
  std::sort(cycles.begin(), cycles.end());
  return cycles;
}

}  // namespace ngs::test
