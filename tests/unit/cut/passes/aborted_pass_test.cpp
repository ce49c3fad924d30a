// With --time-budget a pass that takes too long is aborted and undone. A resumed run repeats this, independently of its
// own clock.
#include <doctest/doctest.h>

#include "support/effect_case.h"
#include "support/fake_clock.h"
#include "support/pipeline_case.h"

namespace ngs {
namespace {

using test::EffectCase;

constexpr int kSteps = 100;
constexpr double kStep_s = 0.01;

/// Works for one second, either in its heuristic or before it removes the first label.
class SlowPass final : public Pass {
 public:
  enum class Part : std::uint8_t { kLooks, kWorks };
  SlowPass(Part part, PassStage stage, int& steps) : Pass({stage}), part_(part), steps_(steps) {}
  std::vector<Effect> effects() const override {
    return {{.name = "slow",
             .help = "take time",
             .saves = "a second",
             .heuristic = {"one", 0.5, "none", [this](SceneProbe& probe) {
                             if (part_ == Part::kLooks) work(*probe.problem().monitor);
                             probe.label_views();
                             return 1.0;
                           }}}};
  }
  void run(PassRun& run) override {
    if (part_ == Part::kWorks) work(run.monitor);
    if (run.monitor.stop_requested()) return;
    std::vector<LabelColumns> labels = run.problem->labels;
    labels[0].label[0] = 0;
    run.problem->labels = std::move(labels);
  }

 private:
  void work(Monitor& monitor) const {
    for (steps_ = 0; steps_ < kSteps && !monitor.stop_requested();) {
      test::FakeClock::advance(kStep_s);
      monitor.progress(++steps_, kSteps);
    }
  }

  Part part_;
  int& steps_;
};

/// Counts the views in the probe's cache, to detect a cache that an aborted heuristic left incomplete.
class CountingPass final : public Pass {
 public:
  explicit CountingPass(std::size_t& views) : Pass({PassStage::kRepair}), views_(views) {}
  std::vector<Effect> effects() const override {
    return {{.name = "counting",
             .help = "count views",
             .saves = "nothing",
             .heuristic = {"views", 0.5, "none", [this](SceneProbe& probe) {
                             views_ = probe.label_views().shown.size();
                             return 0.0;
                           }}}};
  }
  void run(PassRun&) override {}

 private:
  std::size_t& views_;
};

struct SlowCase {
  test::FakeClock clock;
  EffectCase scene;
  Problem in = scene.input();
  int steps = 0;
  std::size_t views = 0;
  std::unique_ptr<test::PipelineCase> passes;

  SlowCase(SlowPass::Part part, const std::string& entry, double budget_s = 2, PassStage stage = PassStage::kRepair) {
    std::vector<std::unique_ptr<Pass>> list = all_passes();
    list.insert(list.begin(), std::make_unique<CountingPass>(views));
    list.insert(list.begin(), std::make_unique<SlowPass>(part, stage, steps));
    const std::vector<std::string> entries{"all=off", entry, "counting=auto"};
    passes = std::make_unique<test::PipelineCase>(in, scene.training, entries, std::move(list));
    passes->time_budget(budget_s);
  }
  bool took_label() const { return passes->solution().labels[0].label[0] == 0; }
  Json decision() const {
    for (const Json& d : passes->report().at("effects"))
      if (d.at("name") == "slow") return d;
    return {};
  }
};

}  // namespace

TEST_CASE("a pass that would take too long is aborted early, undone and reported") {
  SlowCase c(SlowPass::Part::kWorks, "slow=auto");
  const PassRun& run = c.passes->run();
  CHECK(c.steps == kSteps / 10);  // the limit is less than the second of work
  CHECK_FALSE(c.took_label());
  CHECK(run.budget.is_partial());
  CHECK(run.resume.state.at("aborted") == Json({"slow"}));
  CHECK(c.decision().at("on") == false);
  CHECK(c.decision().at("reason").get<std::string>().starts_with("--time-budget: aborted"));
  CHECK_FALSE(run.solution->converged);
}

TEST_CASE("a heuristic that would take too long skips its pass, and leaves no incomplete values in the probe") {
  SlowCase c(SlowPass::Part::kLooks, "slow=auto");
  c.passes->run();
  CHECK(c.steps == kSteps / 10);
  CHECK_FALSE(c.took_label());
  CHECK(c.decision().at("reason") == "--time-budget: skipped, no time left");
  CHECK(c.views == 4);
}

TEST_CASE("a pass is not aborted with enough time, with --effect NAME=on, or in a resumed run") {
  for (const auto& [entry, budget_s] : {std::pair("slow=auto", 1e6), std::pair("slow=on", 2.0)}) {
    SlowCase c(SlowPass::Part::kWorks, entry, budget_s);
    const PassRun& run = c.passes->run();
    CHECK(c.steps == kSteps);
    CHECK(c.took_label());
    CHECK_FALSE(run.resume.state.contains("aborted"));
  }
  SlowCase resumed(SlowPass::Part::kWorks, "slow=auto");
  resumed.passes->resume_from(Json::object());
  resumed.passes->run();
  CHECK(resumed.took_label());
}

TEST_CASE("a resumed run skips the aborted passes and has the same state") {
  SlowCase c(SlowPass::Part::kWorks, "slow=auto", 1e6);
  const Json state = {{"aborted", {"slow"}}, {"coarse_contours_follow", true}};  // without steps it would be false
  c.passes->resume_from(state);
  const PassRun& run = c.passes->run();
  CHECK(c.steps == 0);
  CHECK_FALSE(c.took_label());
  CHECK(run.resume.state == state);
  for (const Json& hostile : {Json({{"aborted", 3}}), Json({{"coarse_contours_follow", 3}}),
                              Json({{"aborted", {1, nullptr}}}), Json({{"aborted", {{"slow", 1}}}})}) {
    SlowCase other(SlowPass::Part::kWorks, "slow=auto", 1e6);
    other.passes->resume_from(hostile);
    other.passes->run();
    CHECK(other.took_label());
  }
}

TEST_CASE("a resumed run repeats the decisions of the stopped run and measures no heuristic") {
  SlowCase before(SlowPass::Part::kLooks, "slow=auto");  // its heuristic is aborted
  const PassRun& run = before.passes->run();
  const Json effects = before.passes->kept();
  CHECK(std::ranges::count(effects, Json("slow=off")) == 1);
  CHECK(std::ranges::none_of(effects, [](const Json& e) { return e.get<std::string>().starts_with("contours"); }));
  CHECK(run.resume.skipped == std::set<std::string>{"slow"});
  for (const bool skipped : {true, false}) {
    SlowCase c(SlowPass::Part::kLooks, "slow=auto", 1e6);
    c.passes->resume_from(run.resume.state, effects, skipped ? Json(run.resume.skipped) : Json());
    const PassRun& resumed = c.passes->run();
    CHECK(c.steps == 0);
    CHECK_FALSE(c.took_label());
    CHECK(c.decision().at("reason") == (skipped ? "--time-budget: skipped, no time left" : "--resume"));
    CHECK(resumed.budget.is_partial() == skipped);
    CHECK(c.passes->kept() == effects);
    CHECK(resumed.resume.skipped.size() == std::size_t(skipped));
  }
  for (const Json& other : {Json{"slow=on"}, Json{"slow=on", 3, nullptr, "slow", "fast=off"}}) {
    SlowCase c(SlowPass::Part::kLooks, "slow=auto", 1e6);
    c.passes->resume_from(run.resume.state, other, Json{"fast", 3});
    c.passes->run();
    CHECK(c.steps == 0);
    CHECK(c.took_label());
  }
  SlowCase insists(SlowPass::Part::kLooks, "slow=on", 1e6);
  insists.passes->resume_from(run.resume.state, effects, Json(run.resume.skipped));
  CHECK_FALSE(insists.passes->run().budget.is_partial());
  CHECK(insists.took_label());
}

namespace {

/// Everything that a repair pass may change.
struct Repaired {
  std::vector<float> label, prob, opacity, photos;
  std::vector<bool> masked;
  bool operator==(const Repaired&) const = default;
};

Repaired repaired(const Problem& problem) {
  Repaired all{problem.labels[0].label.values(), problem.labels[0].prob.values(), problem.cloud.logit_opacity, {}, {}};
  for (std::size_t v = 0; v < 4; ++v) {
    const ImageF photo = problem.load_photo(v);
    all.photos.insert(all.photos.end(), photo.data.begin(), photo.data.end());
    all.masked.push_back(problem.load_masks(v).available);
  }
  return all;
}

/// A scene whose n-th image load requests a stop.
struct StoppedCase {
  EffectCase scene;
  std::atomic<bool> stop = false;
  int loads = 0, raises_at = 0;

  Problem input() {
    Problem in = scene.input();
    in.load_masks = [this](std::size_t v) { return note(), scene.base->masks[v]; };
    in.load_photo = [this](std::size_t v) { return note(), scene.base->photos[v]; };
    return in;
  }
  void note() {
    if (++loads == raises_at) stop = true;
  }
};

}  // namespace

TEST_CASE("a repair pass that is stopped at any image has changed either nothing or everything") {
  struct Case {
    const char* effect;
    void (*needs)(EffectCase&);
  };
  for (const Case& one : {Case{"exposure", test::dark_photo}, Case{"mask-outliers", test::shifted_mask},
                          Case{"floaters", test::floaters_in_front}}) {
    const std::string effect = one.effect;
    CAPTURE(effect);
    const std::vector<std::string> entries{"all=off", effect + "=on"};
    StoppedCase c;
    one.needs(c.scene);
    const Problem in = c.input();
    const Repaired before = repaired(in);
    c.loads = 0;
    test::PipelineCase whole(in, c.scene.training, entries);
    whole.repair();
    const int loads = c.loads;
    const Repaired after = repaired(whole.problem());
    REQUIRE(after != before);
    int undone = 0;
    for (int n = 1; n <= loads; ++n) {
      c.loads = 0;
      c.raises_at = n;
      c.stop = false;
      test::PipelineCase stopped(in, c.scene.training, entries);
      stopped.stop_flag(c.stop);
      stopped.repair();
      c.raises_at = 0;
      const Repaired now = repaired(stopped.problem());
      const bool nothing = now == before;
      undone += nothing;
      CHECK((nothing || now == after));
      CHECK(stopped.report().contains(effect == "mask-outliers" ? "mask_outliers" : effect) != nothing);
    }
    CHECK(undone > 3);
    MESSAGE(effect << ": " << undone << " of " << loads << " stops undo it");
  }
}

namespace {

/// Dilates the mask by `px` along its rows.
void widen(ViewMasks& masks, int px) {
  const std::vector<float> before = masks.target[0];
  for (int i = 0; i < int(before.size()); ++i)
    for (int d = -px; d <= px; ++d)
      if (const int j = i + d; j >= 0 && j < int(before.size()))
        masks.target[0][std::size_t(i)] += before[std::size_t(j)];
  for (float& m : masks.target[0]) m = m > 0 ? 1.f : 0.f;
}

}  // namespace

TEST_CASE("a time budget with time for contours keeps them, and one without runs none") {
  EffectCase c;
  c.fine_photos = true;
  for (ViewMasks& masks : c.base->masks) widen(masks, 2);  // misaligned to one side: they reject no contour
  const Problem in = c.input();
  const auto figures = [&](std::optional<double> budget_s, const std::string& iterations = "1") {
    std::vector<std::string> effects{"all=off", "mask=on", "contours=on"};
    if (iterations != "1") effects.push_back("contour-iterations=on");
    test::PipelineCase passes(in, c.training, effects);
    passes.set("contour_epochs", "4");
    passes.set("contour_iterations", iterations);
    if (budget_s) passes.time_budget(*budget_s);
    return passes.run().solution->figures;
  };
  CHECK(figures({}).at("contour_iterations") == 1);
  const auto long_enough = figures(3600);
  CHECK(long_enough.at("contour_iterations") == 1);
  CHECK_FALSE(long_enough.contains("contour_iterations_undone"));
  CHECK(figures(3600, "2").at("contour_iterations") == 2);  // at half the size, at full size
  CHECK(figures(0.001).count("contour_iterations") == 0);
}

}  // namespace ngs
