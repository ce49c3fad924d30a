// ngs_functions [--all]: lists functions of libngs/ and tools/ above the size limits, or all functions, as
// "path:line function lines parameters nesting". Exit code 1 if a file cannot be parsed as C++.
#include <cstdio>
#include <string_view>

#include "meta/function_budget.h"
#include "support/source_tree.h"

namespace {

using namespace ngs::test;

void list_functions(const SourceFile& file, bool all) {
  for (const CppFunction& f : cpp_functions(file.text))
    if (all || exceeds_budget(f))
      std::printf("%s:%d %s %d %d %d\n", file.path.c_str(), f.line, f.name.c_str(), f.lines, f.parameters, f.nesting);
}

}  // namespace

int main(int argc, char** argv) {
  const bool all = argc > 1 && std::string_view(argv[1]) == "--all";
  int code = 0;
  for (const SourceFile& file : code_files()) {
    try {
      list_functions(file, all);
    } catch (const std::exception& error) {
      std::fprintf(stderr, "%s: %s\n", file.path.c_str(), error.what());
      code = 1;
    }
  }
  return code;
}
