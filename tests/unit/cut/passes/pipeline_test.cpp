// Tests every effect with a heuristic on two scenes. On a scene that needs the effect, auto is on and gives the bytes
// of `on`. On a scene that does not, auto is off, and the rendered masks of off and on differ by at most kEffectBound.
// Tests every other effect, which is always on, on a scene whose masks it changes.
#include "ngs/cut/passes/pipeline.h"

#include <doctest/doctest.h>

#include <cmath>
#include <functional>

#include "ngs/core/error.h"
#include "ngs/cut/evidence/variance_stage.h"
#include "ngs/render/render_stage.h"
#include "support/changed_labels.h"
#include "support/effect_case.h"
#include "support/pipeline_case.h"
#include "support/switches.h"

namespace ngs {
namespace {

using test::EffectCase;

/// Of the mean change of the rendered mask values, in [0, 1], by an effect that `auto` switches off.
constexpr double kEffectBound = 0.005;

void set_contours(const EffectCase& c, test::PipelineCase& passes) {
  passes.set("contour_epochs", std::to_string(c.contour_epochs));
  passes.set("contour_band", "3");
}

Decision decision_on(const EffectCase& c, std::string_view name, const std::vector<std::string>& entries) {
  const Problem in = c.input();
  test::PipelineCase passes(in, c.training, entries);
  set_contours(c, passes);
  for (const Decision& d : passes.decide().all())
    if (d.effect->name == name) {
      Decision decision = d;
      decision.effect = nullptr;  // points into decisions that are destroyed here
      return decision;
    }
  throw std::logic_error("no such effect");
}

/// Rendered mask values of all views after a run with these entries.
std::vector<float> masks_with(const EffectCase& c, const std::vector<std::string>& entries) {
  const Problem in = c.input();
  test::PipelineCase passes(in, c.training, entries);
  set_contours(c, passes);
  const PassRun& run = passes.run();
  std::vector<float> values;
  for (const SceneView& view : c.base->scene.views) {
    const ImageF label =
        render_labelled({}, {*run.solution->cloud, run.solution->labels}, view.camera, {run.problem->splat}).label;
    values.insert(values.end(), label.data.begin(), label.data.end());
  }
  return values;
}

double mean_difference(const std::vector<float>& a, const std::vector<float>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += std::abs(double(a[i]) - double(b[i]));
  return sum / double(a.size());
}

/// Entries for a test of one effect: the effect auto, joint steps on, the other passes off.
std::vector<std::string> surroundings(std::string_view name) {
  std::vector<std::string> entries{"exposure=off",   "mask-outliers=off", "floaters=off",
                                   "components=off", "contours=off",      "joint=on"};
  if (name != "joint" && name != "nerf")
    entries.push_back("nerf=on");  // joint is auto in these tests, and nerf needs it
  if (name == "split" || name == "full-resolution") entries.push_back("contours=on");
  entries.push_back(std::string(name) + "=auto");
  return entries;
}

struct Pair {
  std::string name;
  std::function<void(EffectCase&)> needs, does_not;
};

void as_it_is(EffectCase&) {}
void one_colour(EffectCase& c) { c.paint(0.4f); }
void large_ball(EffectCase& c) {  // its contour lies outside the photos' contour, within reach of the refinement
  c.fine_photos = true;
  for (std::size_t i = 0; i < c.base->is_ball.size(); ++i)
    for (std::size_t k = 0; k < 3 && c.base->is_ball[i] > 0; ++k) c.base->model.log_scale[3 * i + k] += 0.35f;
}
/// Photos and masks of the true model with another focal length.
void focal(EffectCase& c, double focal_px) {
  c.fine_photos = true;
  for (std::size_t v = 0; v < 4; ++v) {
    Camera& camera = c.base->scene.views[v].camera;
    camera.fx = camera.fy = focal_px;
    RenderRequest request{.label = {c.base->is_ball.data(), c.base->truth.size(), 1}};
    const RenderedView seen = render({}, c.base->truth, camera, {}, request);
    c.base->photos[v] = seen.colour;
    for (std::size_t p = 0; p < seen.label.data.size(); ++p) c.base->masks[v].target[0][p] = seen.label.data[p] > 0.5f;
  }
}
/// The default number of steps, part of which the effect saves.
void all_steps(EffectCase& c) {
  c.training.joint.steps = 0;
  c.contour_epochs = 0;
}
void far_ball(EffectCase& c) {  // of 7 px
  all_steps(c);
  focal(c, 24);
  c.relabel();
}
void near_ball(EffectCase& c) {  // of 27 px
  all_steps(c);
  large_ball(c);
  focal(c, 80);
}
void without_photos(EffectCase& c) {
  for (std::size_t v = 0; v < 4; ++v) {
    c.base->scene.views[v].image_path.clear();
    c.base->photos[v] = {};
  }
}
void view_dependent(EffectCase& c) {
  for (std::size_t i = 0; i < c.base->model.sh_rest.size(); ++i)
    c.base->model.sh_rest[i] = 0.2f * float(int(i * 7 % 5) - 2);
}

/// Images so wide that the ball lies far from the masks, which show an object only at their edge.
void wide_pictures(EffectCase& c) {
  constexpr int kWidth_px = 240;
  for (std::size_t v = 0; v < 4; ++v) {
    Camera& camera = c.base->scene.views[v].camera;
    camera.cx += 0.5 * (kWidth_px - camera.width_px);
    camera.width_px = kWidth_px;
    ViewMasks& masks = c.base->masks[v];
    masks.width_px = kWidth_px;
    masks.known.clear();
    masks.target[0].assign(std::size_t(kWidth_px) * std::size_t(masks.height_px), 0.f);
    masks.target[0][0] = 1;
  }
  c.render_photos();
  c.base->labels[0].label = c.base->is_ball;
}

std::vector<Pair> pairs() {
  return {
      {"exposure", test::dark_photo, as_it_is},
      {"mask-outliers", test::shifted_mask, as_it_is},
      {"floaters", test::floaters_in_front, as_it_is},
      {"components",
       [](EffectCase& c) {  // a piece of the wall that one of sixteen views labels object
         test::change(c.base->labels[0].views, [](float v) { return 4 * v; });
         c.base->labels[0].prob[200] = c.base->labels[0].label[200] = c.base->labels[0].views[200] = 1;
       },
       as_it_is},
      {"nerf",
       [](EffectCase& c) {
         large_ball(c);
         without_photos(c);
       },
       large_ball},
      {"rbf", as_it_is, one_colour},
      {"fine-hash", [](EffectCase& c) { c.training.joint.hash_finest = 20; },
       [](EffectCase& c) { c.training.joint.hash_finest = 4096; }},
      {"variance", as_it_is,
       [](EffectCase& c) {
         for (ImageF& photo : c.base->photos) std::fill(photo.data.begin(), photo.data.end(), 0.5f);
       }},
      {"cont", as_it_is, one_colour},
      {"smooth", as_it_is, one_colour},
      {"photometric", as_it_is, without_photos},
      {"whole-photo", wide_pictures, as_it_is},
      {"sh", view_dependent, as_it_is},
      {"antialias",
       [](EffectCase& c) {
         c.base->model.antialiased = true;
         for (float& s : c.base->model.log_scale) s -= 1.5f;
       },
       [](EffectCase& c) { c.base->model.antialiased = false; }},
      {"contours", large_ball,
       [](EffectCase& c) {
         large_ball(c);
         without_photos(c);
       }},
      {"split", large_ball,
       [](EffectCase& c) {
         large_ball(c);
         for (float& s : c.base->model.log_scale) s = -7;
         for (float& o : c.base->model.logit_opacity) o = -1;
         c.relabel();
       }},
      {"full-resolution", far_ball, near_ball},
  };
}

}  // namespace

TEST_CASE(
    "every effect with a heuristic: auto is on for a scene that needs it, off for one that does not, within the "
    "bound") {
  for (const Pair& pair : pairs()) {
    CAPTURE(pair.name);
    const std::vector<std::string> entries = surroundings(pair.name);
    EffectCase needs, does_not;
    pair.needs(needs);
    pair.does_not(does_not);
    const Decision yes = decision_on(needs, pair.name, entries), no = decision_on(does_not, pair.name, entries);
    CAPTURE(yes.reason);
    CAPTURE(no.reason);
    CHECK(yes.on);
    CHECK(yes.mode == "auto");
    CHECK_FALSE(no.on);
    CHECK(no.measured.has_value());
    std::vector<std::string> on = entries, off = entries;
    on.push_back(pair.name + "=on");
    off.push_back(pair.name + "=off");
    CHECK(masks_with(needs, entries) == masks_with(needs, on));
    const double change = mean_difference(masks_with(does_not, off), masks_with(does_not, on));
    MESSAGE(pair.name << ": |off - on| = " << change << " (" << no.reason << ")");
    CHECK(change <= kEffectBound);
  }
}

TEST_CASE("effects that are always on: auto measures nothing and gives the bytes of on, and off changes the masks") {
  for (const Effect& e : Pipeline(all_passes()).effects()) {
    if (e.always.empty() || e.name == "contour-iterations") continue;  // tested below
    CAPTURE(e.name);
    EffectCase c;
    large_ball(c);
    c.relabel(0.05);
    const std::vector<std::string> entries = surroundings(e.name);
    const Decision decision = decision_on(c, e.name, entries);
    CHECK((decision.on && decision.mode == "auto" && !decision.measured));
    std::vector<std::string> on = entries, off = entries;
    on.push_back(std::string(e.name) + "=on");
    off.push_back(std::string(e.name) + "=off");
    const std::vector<float> masks = masks_with(c, on);
    CHECK(masks_with(c, entries) == masks);
    CHECK(mean_difference(masks_with(c, off), masks) > 0);
  }
}

TEST_CASE("a view without a photo switches full-resolution on") {
  EffectCase c;
  near_ball(c);
  CHECK_FALSE(decision_on(c, "full-resolution", surroundings("full-resolution")).on);
  c.base->scene.views[2].image_path.clear();
  c.base->photos[2] = {};
  CHECK(decision_on(c, "full-resolution", surroundings("full-resolution")).on);
}

TEST_CASE("contour-iterations=off refines the contours once") {
  EffectCase c;
  large_ball(c);
  const auto iterations = [&c](const std::string& entry) {
    const Problem in = c.input();
    test::PipelineCase passes(in, c.training, {"joint=off", "contours=on", entry});
    set_contours(c, passes);
    return passes.run().solution->figures.at("contour_iterations");
  };
  CHECK(iterations("contour-iterations=auto") == 2);
  CHECK(iterations("contour-iterations=off") == 1);
}

TEST_CASE("the number of joint steps is reduced only if contour iterations at half the size follow") {
  const EffectCase c;
  const auto go_on = [&c](std::vector<std::string> entries) {
    for (const char* rest : {"nerf=off", "exposure=off", "mask-outliers=off", "floaters=off", "components=off"})
      entries.push_back(rest);
    const Problem in = c.input();
    test::PipelineCase passes(in, c.training, entries);
    passes.set("contour_epochs", "1");
    return passes.run().training.joint.coarse_contours_follow;
  };
  CHECK(go_on({"contours=on", "full-resolution=off"}));
  CHECK_FALSE(go_on({"contours=off", "full-resolution=off"}));
  CHECK_FALSE(go_on({"contours=on", "full-resolution=on"}));
  CHECK_FALSE(go_on({"contours=on", "contour-iterations=off"}));
}

TEST_CASE("entries: the last entry for an effect wins, and `all` sets every effect") {
  const EffectSwitches modes = test::switches_of({"all=off", "nerf=auto", "cont=on", "cont=auto", "components=on"});
  CHECK(modes.of("contours") == Switch::kOff);
  CHECK(modes.of("cont") == Switch::kAuto);
  CHECK(modes.of("components") == Switch::kOn);
  CHECK(test::switches_of({}).of("sh") == Switch::kAuto);
  for (const char* wrong : {"nerf", "nerv=on", "nerf=yes", "=on", "", "all"})
    CHECK_THROWS_AS(test::switches_of({wrong}), Error);
}

TEST_CASE("entries: an effect that is on by name switches on what it needs; an error if that is off by name") {
  const EffectSwitches modes = test::switches_of({"all=off", "align=on"});
  for (const char* name : {"align", "nerf", "joint"}) CHECK(modes.of(name) == Switch::kOn);
  CHECK(modes.of("film") == Switch::kOff);
  CHECK_THROWS_WITH_AS(test::switches_of({"nerf=on", "joint=off"}), doctest::Contains("nerf=on: it needs joint"),
                       Error);
  CHECK(test::switches_of({"all=on", "joint=off"}).of("joint") == Switch::kOff);  // no part of it is on by name
}

TEST_CASE(
    "decisions: a switch overrides a fixed decision, that overrides the heuristic, and an off need overrides all") {
  const EffectCase c;
  const Problem in = c.input();
  test::PipelineCase passes(in, c.training, {"sh=on", "contours=off"});
  for (FixedDecision& verdict : std::vector<FixedDecision>{{"sh", false, "because"},
                                                           {"cont", false, "because", "replayed"},
                                                           {"nerf", false, "too"},
                                                           {"joint", true, "so"}})
    passes.decisions().fix(std::move(verdict));
  for (const Decision& d : passes.decide().all()) {
    CAPTURE(d.effect->name);
    if (d.effect->name == "sh") CHECK((d.on && d.mode == "on"));
    if (d.effect->name == "cont") CHECK((!d.on && d.mode == "replayed" && d.reason == "because"));
    if (d.effect->name == "smooth") CHECK((!d.on && d.reason == "needs nerf"));
  }
}

TEST_CASE(
    "decisions without a heuristic: a need that is off, else a switch, else the first fixed decision, else always on") {
  const FixedDecision no_steps{"joint", false, "no time"}, off{"nerf", false, "first"}, on{"nerf", true, "second"};
  const auto known = [](std::string_view name, const std::vector<std::string>& entries,
                        std::vector<FixedDecision> verdicts) {
    return Decisions(Pipeline(all_passes()).effects(), test::switches_of(entries), std::move(verdicts))
        .on_if_known(name);
  };
  CHECK(known("nerf", {"nerf=on"}, {off, on, no_steps}) == false);  // without steps it is not trained
  CHECK(known("nerf", {"nerf=on"}, {off, on}) == true);
  CHECK(known("nerf", {}, {off, on}) == false);
  CHECK(known("nerf", {}, {on, no_steps}) == false);
  CHECK(known("nerf", {}, {on}) == true);
  CHECK(known("nerf", {}, {no_steps}) == false);  // it needs joint
  CHECK(known("nerf", {"nerf=auto"}, {}) == std::nullopt);
  CHECK(known("film", {}, {}) == true);
  CHECK(known("film", {}, {off}) == false);
}

TEST_CASE("every effect has a help text, a saving, and a reason for being always on or for its threshold") {
  const std::vector<Effect> effects = Pipeline(all_passes()).effects();
  for (const Effect& e : effects) {
    CAPTURE(e.name);
    CHECK_FALSE(e.help.empty());
    CHECK(find_effect(effects, e.name) == &e);
    if (!e.needs.empty()) CHECK(find_effect(effects, e.needs) < &e);  // decided before
    CHECK(e.always.empty() == !e.heuristic.why.empty());
    if (!e.always.empty()) continue;
    CHECK_FALSE(e.saves.empty());
    CHECK_FALSE(e.heuristic.measured.empty());
    CHECK(bool(e.heuristic.measure));
    CHECK((e.heuristic.possible == nullptr) == e.heuristic.impossible.empty());
  }
}

TEST_CASE("reasons print numbers with three digits, and large numbers without an exponent") {
  const Heuristic widths{"width, px", 3, "", {}};
  CHECK(decision_reason(widths, 3128431.2) == "width, px: 3128431 > 3");
  CHECK(decision_reason(widths, 0.12345) == "width, px: 0.123 <= 3");
}

}  // namespace ngs
