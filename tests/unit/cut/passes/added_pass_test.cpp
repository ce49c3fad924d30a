// Adds a pass: one class, and one line of the list.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "support/joint_case.h"
#include "support/pipeline_case.h"

namespace ngs {
namespace {

/// An example of a new pass: removes the labels of large Gaussians.
class OversizedPass : public Pass {
 public:
  OversizedPass() : Pass({PassStage::kRepair}) {}
  std::vector<Effect> effects() const override {
    return {{.name = "oversized",
             .help = "label no Gaussian larger than --oversized-scale",
             .saves = "the scan of the scales",
             .heuristic = {"largest scale, world", 0.5, "half a unit", [](SceneProbe& probe) {
                             const std::vector<float>& s = probe.problem().cloud.log_scale;
                             return double(std::exp(*std::max_element(s.begin(), s.end())));
                           }}}};
  }
  void declare(OptionSet& options, const OptionGroup& given) override {
    OptionGroup group = given;
    group.name = group.effect = "oversized";
    options.add(*this, std::move(group));
  }
  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.scale_, Field<double>{"oversized_scale", "world", "Largest scale of a labelled Gaussian", 0, 1e9});
  }
  void run(PassRun& run) override {
    std::vector<LabelColumns> labels = run.problem->labels;
    std::int64_t count = 0;
    for (std::size_t i = 0; i < labels[0].label.size(); ++i)
      if (std::exp(run.problem->cloud.log_scale[3 * i]) > scale_) {
        labels[0].label[i] = labels[0].prob[i] = 0;
        ++count;
      }
    run.problem->labels = std::move(labels);
    run.report["oversized"] = {{"count", count}};
  }

 private:
  double scale_ = 0.5;
};

}  // namespace

TEST_CASE("a pass added to the list is decided, switched, configured, run and reported like the others") {
  const std::unique_ptr<test::JointCase> c = test::joint_case();
  for (std::size_t a = 0; a < 3; ++a) c->model.log_scale[3 * 7 + a] = 0;  // a Gaussian of scale 1
  const TrainingOptions training;
  const auto passes = [] {
    std::vector<std::unique_ptr<Pass>> list = all_passes();
    list.insert(list.begin() + 4, std::make_unique<OversizedPass>());
    return list;
  };
  const std::vector<std::string> entries{"all=off", "oversized=auto"};
  const Problem in = c->input();
  test::PipelineCase found(in, training, entries, passes());
  const PassRun& run = found.run();
  CHECK(run.report["oversized"]["count"] == 1);
  REQUIRE(run.solution);
  CHECK(run.solution->labels[0].prob[7] == 0);
  CHECK(found.decisions().on("oversized"));
  test::PipelineCase switched_off(in, training, {"all=off"}, passes());
  CHECK_FALSE(switched_off.run().report.contains("oversized"));
  test::PipelineCase larger(in, training, entries, passes());
  larger.set("oversized_scale", "2");
  CHECK(larger.run().report["oversized"]["count"] == 0);
}

}  // namespace ngs
