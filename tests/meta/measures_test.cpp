// Prints size measures of the tree and checks them against limits.
#include <doctest/doctest.h>

#include <algorithm>

#include "meta/function_budget.h"
#include "support/include_graph.h"
#include "support/source_tree.h"

namespace ngs {
namespace {

using test::CppFunction;
using test::SourceFile;

constexpr int kFolderFiles = 30, kFileLines = 400;

struct Measured {
  std::string place;  // "path:function"
  CppFunction function;
};

std::vector<Measured> all_functions() {
  std::vector<Measured> all;
  for (const SourceFile& file : test::code_files())
    for (const CppFunction& f : test::cpp_functions(file.text)) all.push_back({file.path + ":" + f.name, f});
  return all;
}

std::string described(const Measured& m) {
  return m.place + ", line " + std::to_string(m.function.line) + ": " + std::to_string(m.function.lines) + " lines, " +
         std::to_string(m.function.parameters) + " parameters, nesting " + std::to_string(m.function.nesting);
}

/// The ten functions with the largest measure, one per line.
std::string largest(std::vector<Measured> all, int CppFunction::*measure) {
  std::stable_sort(all.begin(), all.end(),
                   [&](const Measured& a, const Measured& b) { return a.function.*measure > b.function.*measure; });
  std::string text;
  for (std::size_t i = 0; i < std::min<std::size_t>(10, all.size()); ++i) text += "\n  " + described(all[i]);
  return text;
}

/// Size and name of folders or files; `largest` prints the five largest.
using Sizes = std::vector<std::pair<int, std::string>>;
std::string largest(Sizes sizes) {
  std::sort(sizes.rbegin(), sizes.rend());
  std::string text;
  for (std::size_t i = 0; i < std::min<std::size_t>(5, sizes.size()); ++i)
    text += "\n  " + std::to_string(sizes[i].first) + " " + sizes[i].second;
  return text;
}
std::vector<std::string> over_limit(const Sizes& sizes, int budget) {
  std::vector<std::string> offenders;
  for (const auto& [size, name] : sizes)
    if (size > budget)
      offenders.push_back(name + ": " + std::to_string(size) + ", expected at most " + std::to_string(budget));
  return offenders;
}

}  // namespace

TEST_CASE("no function has more than 60 lines, 5 parameters or 4 levels, except listed exceptions") {
  const std::vector<Measured> all = all_functions();
  MESSAGE(all.size() << " functions; the longest:" << largest(all, &CppFunction::lines)
                     << "\nthe most parameters:" << largest(all, &CppFunction::parameters)
                     << "\nthe deepest:" << largest(all, &CppFunction::nesting));
  std::vector<std::string> offenders;
  for (const Measured& m : all)
    if (test::exceeds_budget(m.function) && test::function_exceptions().count(m.place) == 0)
      offenders.push_back(described(m));
  CHECK(test::listed(offenders) == "");
}

TEST_CASE("there are at most ten exceptions, each with a reason and still needed") {
  const std::vector<Measured> all = all_functions();
  CHECK(test::function_exceptions().size() <= test::kMaxExceptions);
  for (const auto& exception : test::function_exceptions()) {
    CAPTURE(exception.first);
    CHECK(exception.second.size() > 20);
    CHECK(std::any_of(all.begin(), all.end(), [&](const Measured& m) {
      return m.place == exception.first && test::exceeds_budget(m.function);
    }));
  }
}

TEST_CASE("there are no include cycles between units") {
  const test::IncludeGraph graph = test::include_graph(test::code_files());
  const std::vector<std::vector<std::string>> cycles = test::include_cycles(graph);
  MESSAGE(graph.size() << " units, " << cycles.size() << " cycles");
  std::string text;
  for (const std::vector<std::string>& cycle : cycles) {
    for (const std::string& unit : cycle) text += unit + " ";
    text += "\n";
  }
  CHECK(text == "");
}

TEST_CASE("no folder has more than 30 source files, and no file more than 400 lines") {
  std::map<std::string, int> in_folder;
  Sizes folders, files;
  for (const SourceFile& file : test::code_files()) {
    ++in_folder[file.path.substr(0, file.path.rfind('/'))];
    files.emplace_back(int(std::count(file.text.begin(), file.text.end(), '\n')), file.path);
  }
  for (const auto& [folder, count] : in_folder) folders.emplace_back(count, folder);
  MESSAGE(folders.size() << " folders, by files:" << largest(folders) << "\n"
                         << files.size() << " files, by lines:" << largest(files));
  CHECK(test::listed(over_limit(folders, kFolderFiles)) == "");
  CHECK(test::listed(over_limit(files, kFileLines)) == "");
}

}  // namespace ngs
