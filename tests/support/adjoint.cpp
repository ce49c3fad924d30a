#include "support/adjoint.h"

#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>

#include "support/end_listener.h"

namespace ngs::test {
namespace {

struct WorstOfOp {
  double adjoint = 0, ridders = 0;
  int adjoints = 0, extrapolations = 0;
};

std::map<std::string, WorstOfOp>& worst_of_ops() {
  static std::map<std::string, WorstOfOp> all;
  return all;
}

WorstOfOp& current_op() {
  const std::string name = doctest::getContextOptions()->currentTest->m_name;
  return worst_of_ops()[name.substr(0, name.find(':'))];
}

/// Prints the table once all cases have run.
struct GradTable : EndListener {
  explicit GradTable(const doctest::ContextOptions&) {}
  void test_run_end(const doctest::TestRunStats&) override {
    if (std::getenv("NGS_GRAD_TABLE") == nullptr || worst_of_ops().empty()) return;
    std::printf("%-14s %16s %10s %16s %10s\n", "op", "adjoint, worst", "tests", "Ridders, worst", "tests");
    for (const auto& [op, worst] : worst_of_ops())
      std::printf("%-14s %16.2g %10d %16.2g %10d\n", op.c_str(), worst.adjoint, worst.adjoints, worst.ridders,
                  worst.extrapolations);
  }
};
REGISTER_LISTENER("gradients", 1, GradTable);

}  // namespace

double adjoint_difference(double jv, double jtu, double scale) {
  const double size = std::max({std::abs(jv), std::abs(jtu), scale});
  const double difference = size == 0 ? 0 : std::abs(jv - jtu) / size;
  WorstOfOp& op = current_op();
  op.adjoint = std::max(op.adjoint, difference);
  ++op.adjoints;
  return difference;
}

double ridders_difference(double numeric, double gradient) {
  const double difference = relative_difference(numeric, gradient);
  WorstOfOp& op = current_op();
  op.ridders = std::max(op.ridders, difference);
  ++op.extrapolations;
  return difference;
}

}  // namespace ngs::test
