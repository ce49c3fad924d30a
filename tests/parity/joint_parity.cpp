// Steps of the joint optimisation with every op that has a device path on the device.
#include "ngs/stages/joint_stage.h"
#include "parity/backends.h"
#include "support/joint_case.h"

namespace ngs::test {
namespace {

std::vector<LossTerms> losses(const Exec& exec, const JointCase& c, int steps) {
  JointOptions options;
  options.mlp_hidden = 16, options.hash_levels = 3, options.hash_log2_table = 8, options.smooth_points = 32;
  options.steps = 8;
  SampleOptions sample;
  sample.rows = sample.cols = 8, sample.depth_samples = 4;
  const RbfOptions rbf;
  const MethodInput input = c.input();
  Monitor monitor;
  JointTrainer trainer(exec, monitor, {.options = options, .sample = sample, .rbf = rbf, .input = input}, false);
  std::vector<LossTerms> values;
  for (int i = 0; i < steps; ++i) values.push_back(trainer.step().loss);
  return values;
}

}  // namespace

TEST_CASE("joint: the losses of the first steps on a device are the CPU's") {
  const auto c = joint_case(60, 40);
  const std::vector<LossTerms> want = losses({}, *c, 3);
  for (const Backend& b : backends()) {
    const std::vector<LossTerms> got = losses(b.exec, *c, 3);
    for (std::size_t step = 0; step < want.size(); ++step) {
      // A first step differs by rounding. Adam divides by the root of squares: where a gradient is nearly zero, rounding
      // decides its sign, and the next steps start from slightly other parameters.
      const double bound = step == 0 ? 100 : 1e5;
      const auto term = [&](const char* name, double LossTerms::*member) {
        const double w = want[step].*member, error = std::abs(got[step].*member - w);
        check_ratio(b, std::string("joint ") + name + (step == 0 ? ", first step" : ", later steps"),
                    error / (1.2e-7 * std::max(w, 1e-3)), bound);
      };
      term("align", &LossTerms::align), term("mask", &LossTerms::mask), term("cont", &LossTerms::cont);
      term("smooth", &LossTerms::smooth), term("photometric", &LossTerms::photometric);
    }
  }
}

}  // namespace ngs::test
