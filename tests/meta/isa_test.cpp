// A translation unit compiled for newer processors must not export inline functions under shared names: the linker
// could keep that copy for the whole program, which would then crash on older processors.
#include <doctest/doctest.h>

#include <regex>
#include <sstream>

#include "support/process.h"
#include "support/skip.h"
#include "support/source_tree.h"

namespace ngs {
namespace {

/// Symbols in `nm -C` output that another translation unit could define too, except those containing `pack`.
std::vector<std::string> shared_symbols(const std::string& listing, const std::string& pack) {
  static const std::regex shared("[0-9a-f]* +[WVBDRu] (.*)");
  std::vector<std::string> found;
  std::istringstream lines(listing);
  std::smatch match;
  for (std::string line; std::getline(lines, line);)
    if (std::regex_match(line, match, shared) && match[1].str().find(pack) == std::string::npos)
      found.push_back(match[1]);
  return found;
}

void check_object(const char* object, const std::string& pack) {
  const test::ProcessResult nm = test::run_command({"/usr/bin/nm", "-C", object});
  if (nm.exit_code != 0) return test::skip("no nm");
  CHECK(nm.out.find(pack) != std::string::npos);
  CHECK(test::listed(shared_symbols(nm.out, pack)) == "");
}

}  // namespace

TEST_CASE("the code for x86-64-v4 shares no symbol with other translation units") {
  CHECK(
      shared_symbols("0000 W ngs::clamped(double)\n0000 W void ngs::f<ngs::Pack16>()\n0000 T g()\n", "Pack16").size() ==
      1);
#ifdef NGS_V4_OBJECT
  check_object(NGS_V4_OBJECT, "Pack16");
#else
  test::skip("this build has no code for x86-64-v4");
#endif
}

TEST_CASE("the code for x86-64-v3 of a build for any x86-64 shares no symbol with other translation units") {
#ifdef NGS_V3_OBJECT
  check_object(NGS_V3_OBJECT, "ngs::PackF");
#else
  test::skip("this build is for x86-64-v3 as a whole, or for another processor");
#endif
}

}  // namespace ngs
