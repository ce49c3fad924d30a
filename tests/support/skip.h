#pragma once
// What a case does whose needs are absent: a scene, a program, a processor.
#include <string>

namespace ngs::test {

/// The running case counts as skipped, not as passed, unless one of its checks has failed:
///   if (!here) return test::skip("no scene bird in ../shared/scenes");
/// At its end the suite prints "skipped: CASE: REASON" for each, then "skipped cases: N" (tests/ci/count-tests.awk).
void skip(const std::string& reason);

}  // namespace ngs::test
