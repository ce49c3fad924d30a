// The translation unit for x86-64-v4 must not lend its code to the rest of the program: an inline function that it
// emits under a shared name could be the copy that the linker keeps, and the program would die on older processors.
#include <doctest/doctest.h>

#include <regex>
#include <sstream>

#include "support/process.h"
#include "support/skip.h"
#include "support/source_tree.h"

namespace ngs {
namespace {

/// Symbols of `nm -C` output that another translation unit could define too, beside those named after Pack16.
std::vector<std::string> shared_symbols(const std::string& listing) {
  static const std::regex shared("[0-9a-f]* +[WVBDRu] (.*)");
  std::vector<std::string> found;
  std::istringstream lines(listing);
  std::smatch match;
  for (std::string line; std::getline(lines, line);)
    if (std::regex_match(line, match, shared) && match[1].str().find("Pack16") == std::string::npos)
      found.push_back(match[1]);
  return found;
}

}  // namespace

TEST_CASE("the code for x86-64-v4 shares no symbol with other translation units") {
  CHECK(shared_symbols("0000 W ngs::clamped(double)\n0000 W void ngs::f<ngs::Pack16>()\n0000 T g()\n").size() == 1);
#ifdef NGS_V4_OBJECT
  test::ProcessSpec spec;
  spec.argv = {"/usr/bin/nm", "-C", NGS_V4_OBJECT};
  const test::ProcessResult nm = test::run_process(spec);
  if (nm.exit_code != 0) return test::skip("no nm");
  CHECK(nm.out.find("Pack16") != std::string::npos);
  CHECK(test::listed(shared_symbols(nm.out)) == "");
#else
  test::skip("this build has no code for x86-64-v4");
#endif
}

}  // namespace ngs
