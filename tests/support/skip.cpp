#include "support/skip.h"

#include <cstdio>
#include <vector>

#include "support/end_listener.h"

namespace ngs::test {
namespace {

std::vector<std::string>& skipped() {
  static std::vector<std::string> all;
  return all;
}
std::string reason_of_case;  // of the running case

struct SkipCounter : EndListener {
  explicit SkipCounter(const doctest::ContextOptions& o) : options(o) {}
  void test_case_start(const doctest::TestCaseData&) override { reason_of_case.clear(); }
  void test_case_end(const doctest::CurrentTestCaseStats& result) override {
    if (reason_of_case.empty() || !result.testCaseSuccess) return;
    skipped().push_back(std::string(options.currentTest->m_name) + ": " + reason_of_case);
  }
  void test_run_end(const doctest::TestRunStats&) override {
    for (const std::string& text : skipped()) std::printf("skipped: %s\n", text.c_str());
    if (!skipped().empty()) std::printf("skipped cases: %zu\n", skipped().size());
    std::fflush(stdout);
  }
  const doctest::ContextOptions& options;
};
REGISTER_LISTENER("skips", 1, SkipCounter);

}  // namespace

void skip(const std::string& reason) { reason_of_case = reason; }

}  // namespace ngs::test
