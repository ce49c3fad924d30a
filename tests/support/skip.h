#pragma once
// Skips a case whose requirements (a scene, a program, a processor) are missing.
#include <string>

namespace ngs::test {

/// Marks the running case as skipped, not passed, unless one of its checks has failed:
///   if (!here) return test::skip("no scene bird in ../shared/scenes");
/// At the end the suite prints "skipped: CASE: REASON" for each, then "skipped cases: N" (tests/ci/count-tests.awk).
void skip(const std::string& reason);

}  // namespace ngs::test
