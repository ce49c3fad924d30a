// Adds a loss term: one class, and one line of the list.
#include <doctest/doctest.h>

#include <numeric>

#include "ngs/cut/training/loss_term.h"
#include "support/joint_case.h"
#include "support/pipeline_case.h"

namespace ngs {
namespace {

double sum(const std::vector<float>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

/// An example of a new term: the mean of the rendered labels, which prefers small objects.
struct AreaTerm final : LossTerm {
  double weight = 10;

  std::vector<Effect> effects() const override {
    return {{.name = "area", .help = "prefer small objects", .heuristic = {"Gaussians", 1, "none", [](SceneProbe& p) {
                                                                             return double(p.problem().cloud.size());
                                                                           }}}};
  }
  void declare(OptionSet& options, const OptionGroup& group) override { options.add(*this, group); }
  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.weight, Field<double>{"lambda_area", "", "Weight of the rendered area", 0, 1e6}.of("area"));
  }
  std::unique_ptr<LossTerm> copy() const override { return std::make_unique<AreaTerm>(*this); }
  void add_on_view(LossStep& step) override {
    const std::vector<float>& label = step.rendered.label.data;
    for (float& g : step.images.added(&ViewGradients::label).data) g += float(weight / double(label.size()));
    step.values.set("area", weight, sum(label) / double(label.size()));
  }
};

}  // namespace

TEST_CASE(
    "a loss term added to the list is decided, switched, weighted, trained, traced and reported like the others") {
  const auto c = test::joint_case();
  const Problem in = c->input();
  const auto labels = [&](const std::string& area, const std::string& weight) {
    TrainingOptions training;
    training.losses.push_back(std::make_shared<AreaTerm>());
    training.joint.steps = 8;
    test::PipelineCase passes(in, training, {"all=off", "joint=on", "mask=on", "area=" + area});
    passes.set("lambda_area", weight);
    passes.trace();
    const PassRun& run = passes.run();
    const bool is_on = run.on("area");
    CHECK((run.report["last_loss"]["area"] > 0) == is_on);
    CHECK((run.optimisation.tracker->trace().find(R"("area":0.0})") == std::string::npos) == is_on);
    return sum(run.solution->labels[0].prob.values());
  };
  const double off = labels("off", "10");
  CHECK(labels("auto", "10") < 0.99 * off);
  CHECK(labels("on", "0") == off);
}

}  // namespace ngs
