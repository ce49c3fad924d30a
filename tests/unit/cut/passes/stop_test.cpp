// A stop request ends every phase after the current view: no phase loads another view.
#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>

#include "ngs/cut/contours/refined_masks.h"
#include "ngs/cut/contours/straddler_split.h"
#include "ngs/cut/evidence/method_labels.h"
#include "ngs/cut/passes/agreement.h"
#include "ngs/cut/passes/bleed_through/bleed_through.h"
#include "ngs/cut/passes/exposure/exposure.h"
#include "ngs/cut/passes/floaters/floaters.h"
#include "ngs/cut/passes/mask_outliers/mask_outliers.h"
#include "ngs/cut/training/scene_probe.h"
#include "ngs/problem/coarse_input.h"
#include "ngs/problem/view_list.h"
#include "support/changed_labels.h"
#include "support/joint_case.h"

namespace ngs {
namespace {

constexpr std::size_t kViews = 12;

/// A scene of many views. Loading the third view requests a stop.
struct StopCase {
  std::unique_ptr<test::JointCase> base = test::joint_case();
  mutable Monitor monitor;
  mutable std::atomic<bool> stop = false;
  mutable int loads = 0, later_loads = 0;
  bool raises = true;

  StopCase() {
    monitor.stop_flag(&stop);
    for (std::size_t v = 4; v < kViews; ++v) {
      base->scene.views.push_back(base->scene.views[v % 4]);
      base->photos.push_back(base->photos[v % 4]);
      base->masks.push_back(base->masks[v % 4]);
    }
    for (SceneView& view : base->scene.views) view.image_path = "photo";
  }
  Problem input() const {
    Problem in = base->input();
    in.views.clear();
    for (std::size_t v = 0; v < kViews; ++v) in.views.push_back(v);
    in.load_masks = [this](std::size_t v) { return note(v), base->masks[v]; };
    in.load_photo = in.load_fine_photo = [this](std::size_t v) { return note(v), base->photos[v]; };
    in.monitor = &monitor;
    return in;
  }
  void note(std::size_t view) const {
    ++loads;
    if (stop && view != 2) ++later_loads;
    if (raises && view == 2) stop = true;
  }
};

struct Phase {
  const char* name;
  std::function<void(const StopCase&, const Problem&)> run;
};

void measure(const Problem& in) {
  const TrainingOptions training;
  SceneProbe probe({}, training, in);
  probe.label_views();
}

const Phase kPhases[] = {
    {"load views", [](const StopCase&, const Problem& in) { CoarseInput(in, 1).preload({}); }},
    {"exposures", [](const StopCase&, const Problem& in) { view_exposures({}, in, in.views); }},
    {"heuristics", [](const StopCase&, const Problem& in) { measure(in); }},
    {"mask outliers", [](const StopCase& c, const Problem& in) { find_mask_outliers({}, c.monitor, in); }},
    {"recomputed evidence",
     [](const StopCase& c, const Problem& in) { recompute_labels({}, c.monitor, in, in.cloud); }},
    {"floaters", [](const StopCase& c, const Problem& in) { find_floaters({}, c.monitor, {}, in); }},
    {"agreement",
     [](const StopCase&, const Problem& in) {
       training_agreement({}, in, {unchanged(in.cloud), {}, in.labels, {}});
     }},
    {"bleed-through",
     [](const StopCase&, const Problem& in) {
       std::vector<LabelColumns> uncertain = in.labels;
       test::change(uncertain[0].prob, [](float p) { return std::min(p, 0.7f); });
       without_bleed_through({}, in, std::move(uncertain));
     }},
    {"straddling", [](const StopCase&, const Problem& in) { straddling({}, in, in.cloud); }},
    {"refinement",
     [](const StopCase&, const Problem& in) {
       refine_views({}, {{}, 6, in, 1}, {in.cloud, in.labels}, in.views, in.views);
     }},
};

}  // namespace

TEST_CASE("a stop request ends a phase after the current view") {
  for (const Phase& phase : kPhases) {
    CAPTURE(phase.name);
    StopCase undisturbed, stopped;
    undisturbed.raises = false;
    phase.run(undisturbed, undisturbed.input());
    CHECK(undisturbed.loads >= int(kViews));
    phase.run(stopped, stopped.input());
    CHECK(stopped.stop);
    CHECK(stopped.later_loads == 0);
  }
}

TEST_CASE("for_each_view visits views in order with their positions, until a stop is requested") {
  Monitor monitor;
  std::atomic<bool> stop = false;
  monitor.stop_flag(&stop);
  std::vector<std::int64_t> progress;
  monitor.on_progress = [&](const std::string&, std::int64_t done, std::int64_t) { progress.push_back(done); };
  std::vector<std::size_t> seen;
  const auto until_five = [&](std::size_t n, std::size_t view) {
    CHECK(n == seen.size());
    seen.push_back(view);
    stop = view == 5;
  };
  CHECK_FALSE(for_each_view(&monitor, {3, 5, 7}, until_five));
  CHECK(seen == std::vector<std::size_t>{3, 5});
  CHECK(progress == std::vector<std::int64_t>{1, 2});
  stop = false;
  seen.clear();
  CHECK(for_each_view(&monitor, {3, 4}, until_five));
  seen.clear();
  CHECK(for_each_view(nullptr, {5, 7}, until_five));
  CHECK(for_each_view(&monitor, {}, until_five));
}

}  // namespace ngs
