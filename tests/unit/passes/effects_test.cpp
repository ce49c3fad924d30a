// For each effect with a detector a scene that needs it, on which auto is on and gives the bytes of `on`, and
// one that does not, on which auto is off and the rendered masks of off and on differ by at most
// kEffectBound. For each of the others, which are always on, a scene whose masks it changes.
#include "ngs/passes/effects.h"

#include <doctest/doctest.h>

#include <cmath>
#include <functional>

#include "ngs/core/error.h"
#include "ngs/passes/effect_probe.h"
#include "ngs/passes/exposure/exposure.h"
#include "ngs/passes/floaters/floaters.h"
#include "ngs/passes/joint/joint_stage.h"
#include "ngs/stages/render/render_stage.h"
#include "ngs/passes/components/components.h"
#include "ngs/passes/mask_outliers/mask_outliers.h"
#include "support/joint_case.h"

namespace ngs {
namespace {

/// The joint case, to be bent, and the stages of ngs-joint on it.
struct EffectCase {
  std::unique_ptr<test::JointCase> base = test::joint_case();
  ContourOptions edge;
  JointOptions joint;
  SampleOptions sample;
  RbfOptions rbf;
  bool fine_photos = false;

  EffectCase() {
    joint.steps = 12, joint.hash_levels = 3, joint.hash_log2_table = 8, joint.hash_finest = 48;
    joint.mlp_hidden = 16, joint.smooth_points = 64;
    sample.rows = sample.cols = 10, sample.depth_samples = 4;
    edge.visits = 4, edge.margin_px = 6, edge.walk.reach_px = 8, edge.walk.band_px = 3;
    for (SceneView& v : base->scene.views) v.image_path = "photo";
  }
  Problem input() const {
    Problem in = base->input();
    if (fine_photos) in.load_fine_photo = in.load_photo;
    in.splat.antialiased = base->model.antialiased;
    return in;
  }
  void relabel(double tau = 0.2) {
    Monitor monitor;
    VarianceOptions options;
    options.tau = tau;
    base->labels =
        label_gaussians(options, accumulate_evidence({}, monitor, base->model, base->scene, {0, 1, 2, 3},
                                                     base->input().splat, base->input().load_masks));
  }
  void render_photos(const SplatOptions& splat = {}) {
    for (std::size_t v = 0; v < 4; ++v)
      base->photos[v] = render({}, base->model, base->scene.views[v].camera, splat, {}).colour;
  }
  void paint(float value) {  // everything in one colour, photos too
    std::fill(base->model.sh_dc.begin(), base->model.sh_dc.end(), value);
    render_photos();
  }
};

EffectDecision decision_on(const EffectCase& c, std::string_view name,
                           const std::vector<std::string>& entries) {
  Monitor monitor;
  JointOptions joint = c.joint;
  joint.effect = entries;
  const Problem in = c.input();
  const EffectSetup setup{joint, c.edge, c.sample, c.rbf, in};
  std::vector<EffectDecision> all;
  for (const EffectPhase phase : {EffectPhase::kBefore, EffectPhase::kSteps}) {
    const auto more = decide_effects({}, monitor, setup, phase, {}, all);
    all.insert(all.end(), more.begin(), more.end());
  }
  for (const EffectDecision& d : all)
    if (d.effect->name == name) return d;
  throw std::logic_error("no such effect");
}

/// Rendered mask values of all views after the stages that the entries leave on.
std::vector<float> masks_with(const EffectCase& c, const std::vector<std::string>& entries) {
  Monitor monitor;
  JointOptions joint = c.joint;
  joint.effect = entries;
  const JointEffects effects = parse_effects(entries);
  Problem read = c.input();
  std::vector<ViewExposure> exposures;
  if (effects.exposure) exposures = view_exposures({}, read, read.views);
  read.load_photo = [&, load = read.load_photo](std::size_t v) { return levelled_photo(exposures, v, load(v)); };
  if (read.load_fine_photo) read.load_fine_photo = read.load_photo;
  Problem in = read;
  MaskOutliers trust;
  if (effects.mask_outliers) trust = judge_views({}, monitor, {}, in);
  in.load_masks = [&](std::size_t v) { return consistent_masks(trust, v, read.load_masks(v)); };
  FloaterFinding finding;
  if (effects.floaters) finding = find_floaters({}, monitor, {}, in);
  GaussianCloud cloud = c.base->model;
  for (std::size_t i = 0; i < finding.floater.size(); ++i)
    if (finding.floater[i]) cloud.logit_opacity[i] = kRemovedLogit;
  Problem clean{.cloud = cloud,
                    .scene = in.scene,
                    .views = in.views,
                    .load_masks = in.load_masks,
                    .load_photo = in.load_photo,
                    .splat = in.splat,
                    .background = {},
                    .seed = in.seed,
                    .fixed = {},
                    .labels = in.labels,
                    .load_fine_photo = in.load_fine_photo};
  ComponentFinding components{in.labels, {}};
  if (effects.components) components = find_disconnected({}, {}, clean);
  clean.labels = components.labels, clean.held = components.stray;
  clean.splat.antialiased = in.splat.antialiased && effects.antialias;
  JointTrainer trainer({}, monitor, {joint, c.sample, c.rbf, clean}, true);
  while (effects.joint && !trainer.finished()) trainer.step();
  Solution result = trainer.result();
  result.converged = true;
  if (effects.edges && c.fine_photos)
    result = refine_contours({}, monitor, {c.edge, joint, c.sample, c.rbf, clean}, std::move(result));
  std::vector<float> values;
  for (const SceneView& view : c.base->scene.views) {
    const ImageF label =
        render_labelled({}, result.cloud, result.labels, view.camera, clean.splat, {}, false).label;
    values.insert(values.end(), label.data.begin(), label.data.end());
  }
  return values;
}

double mean_difference(const std::vector<float>& a, const std::vector<float>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += std::abs(double(a[i]) - double(b[i]));
  return sum / double(a.size());
}

/// Steps on, unless it is they that are asked about; what surrounds them off.
std::vector<std::string> surroundings(std::string_view name) {
  std::vector<std::string> entries{"exposure=off", "mask-outliers=off", "floaters=off", "components=off", "contours=off", "joint=on"};
  for (const char* part : {"nerf=on", "align=on"}) entries.push_back(part);
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
void large_ball(EffectCase& c) {  // its contour lies outside of the photos', where the walk finds it
  c.fine_photos = true;
  for (std::size_t i = 0; i < c.base->is_ball.size(); ++i)
    for (std::size_t k = 0; k < 3 && c.base->is_ball[i] > 0; ++k) c.base->model.log_scale[3 * i + k] += 0.35f;
}
/// Photos and masks of the true model through another lens.
void focal(EffectCase& c, double focal_px) {
  c.fine_photos = true;
  for (std::size_t v = 0; v < 4; ++v) {
    Camera& camera = c.base->scene.views[v].camera;
    camera.fx = camera.fy = focal_px;
    RenderRequest request;
    request.label = {c.base->is_ball.data(), c.base->truth.size(), 1};
    const RenderedView seen = render({}, c.base->truth, camera, {}, request);
    c.base->photos[v] = seen.colour;
    for (std::size_t p = 0; p < seen.label.data.size(); ++p) c.base->masks[v].target[0][p] = seen.label.data[p] > 0.5f;
  }
}
/// As many steps as by default: that is what the effect saves.
void all_steps(EffectCase& c) { c.joint.steps = 0, c.edge.visits = 0; }
void far_ball(EffectCase& c) { all_steps(c), focal(c, 24), c.relabel(); }   // of 7 px
void near_ball(EffectCase& c) { all_steps(c), large_ball(c), focal(c, 80); }  // of 27 px
void without_photos(EffectCase& c) {
  for (std::size_t v = 0; v < 4; ++v) c.base->scene.views[v].image_path.clear(), c.base->photos[v] = {};
}
void view_dependent(EffectCase& c) {
  for (std::size_t i = 0; i < c.base->model.sh_rest.size(); ++i)
    c.base->model.sh_rest[i] = 0.2f * float(int(i * 7 % 5) - 2);
}

std::vector<Pair> pairs() {
  return {
      {"exposure",
       [](EffectCase& c) {
         for (float& x : c.base->photos[1].data) x *= 0.8f;
       },
       as_it_is},
      {"mask-outliers",
       [](EffectCase& c) {
         auto& mask = c.base->masks[1].target[0];
         std::rotate(mask.begin(), mask.begin() + 480 + 14, mask.end());
       },
       as_it_is},
      {"floaters",
       [](EffectCase& c) {  // the wall's first Gaussians hang before the ball
         for (std::size_t i = 160; i < 166; ++i)
           c.base->model.position[3 * i] = 0.05f * float(i - 163), c.base->model.position[3 * i + 1] = 0,
                                      c.base->model.position[3 * i + 2] = 1.5f;
       },
       as_it_is},
      {"components",
       [](EffectCase& c) {  // a piece of the wall that one of sixteen views claims
         for (float& v : c.base->labels[0].views) v *= 4;
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
      {"fine-hash", [](EffectCase& c) { c.joint.hash_finest = 20; },
       [](EffectCase& c) { c.joint.hash_finest = 4096; }},
      {"variance", as_it_is,
       [](EffectCase& c) {
         for (ImageF& photo : c.base->photos) std::fill(photo.data.begin(), photo.data.end(), 0.5f);
       }},
      {"cont", as_it_is, one_colour},
      {"smooth", as_it_is, one_colour},
      {"photometric", as_it_is, without_photos},
      {"region",
       [](EffectCase& c) {  // masks of a corner of the ball: labels show far from them
         for (ViewMasks& m : c.base->masks) std::fill(m.target[0].begin(), m.target[0].end(), 0.f);
         c.base->labels[0].label = c.base->is_ball;
       },
       as_it_is},
      {"sh", view_dependent, as_it_is},
      {"antialias",
       [](EffectCase& c) {
         c.base->model.antialiased = true;
         for (float& s : c.base->model.log_scale) s -= 1.5f;
       },
       [](EffectCase& c) { c.base->model.antialiased = false; }},
      {"contours",
       large_ball,
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
    "every effect with a detector: auto is on where the scene needs it, off where it does not, within the "
    "bound") {
  for (const Pair& pair : pairs()) {
    CAPTURE(pair.name);
    const std::vector<std::string> entries = surroundings(pair.name);
    EffectCase needs, does_not;
    pair.needs(needs), pair.does_not(does_not);
    const EffectDecision yes = decision_on(needs, pair.name, entries),
                         no = decision_on(does_not, pair.name, entries);
    CAPTURE(yes.reason);
    CAPTURE(no.reason);
    CHECK(yes.on);
    CHECK(yes.mode == "auto");
    CHECK_FALSE(no.on);
    CHECK(no.measured.has_value());
    std::vector<std::string> on = entries, off = entries, decided = entries;
    on.push_back(pair.name + "=on"), off.push_back(pair.name + "=off");
    for (const std::string& entry : decided_entries({yes})) decided.push_back(entry);
    CHECK(masks_with(needs, decided) == masks_with(needs, on));
    const double change = mean_difference(masks_with(does_not, off), masks_with(does_not, on));
    MESSAGE(pair.name << ": |off - on| = " << change << " (" << no.reason << ")");
    CHECK(change <= kEffectBound);
  }
}

TEST_CASE("always on: auto decides so without a look, gives the bytes of on, and off changes the masks") {
  for (const EffectInfo& e : effect_registry()) {
    if (e.on != OnWhere::kAlways || e.name == "contour-iterations") continue;  // that has a test of its own
    CAPTURE(e.name);
    EffectCase c;
    large_ball(c);
    c.relabel(0.05);
    const std::vector<std::string> entries = surroundings(e.name);
    const EffectDecision decision = decision_on(c, e.name, entries);
    CHECK((decision.on && decision.mode == "auto" && !decision.measured));
    std::vector<std::string> on = entries, off = entries, decided = entries;
    on.push_back(std::string(e.name) + "=on"), off.push_back(std::string(e.name) + "=off");
    for (const std::string& entry : decided_entries({decision})) decided.push_back(entry);
    const std::vector<float> masks = masks_with(c, on);
    CHECK(masks_with(c, decided) == masks);
    CHECK(mean_difference(masks_with(c, off), masks) > 0);
  }
}

TEST_CASE("a view without a photo asks for the full size in all rounds") {
  EffectCase c;
  near_ball(c);
  CHECK_FALSE(decision_on(c, "full-resolution", surroundings("full-resolution")).on);
  c.base->scene.views[2].image_path.clear(), c.base->photos[2] = {};
  CHECK(decision_on(c, "full-resolution", surroundings("full-resolution")).on);
}

TEST_CASE("without the second round the edges are followed once") {
  EffectCase c;
  large_ball(c);
  const auto rounds = [&c](const char* entry) {
    Monitor monitor;
    JointOptions joint = c.joint;
    joint.effect = {entry};
    const Problem in = c.input();
    JointTrainer trainer({}, monitor, {joint, c.sample, c.rbf, in}, true);
    Solution start = trainer.result();
    start.converged = true;
    return refine_contours({}, monitor, {c.edge, joint, c.sample, c.rbf, in}, std::move(start)).figures;
  };
  CHECK(rounds("contour-iterations=auto").at("contour_iterations") == 2);
  CHECK(rounds("contour-iterations=off").at("contour_iterations") == 1);
}

TEST_CASE("entries: the last one that names an effect counts, all names every one") {
  const auto modes = effect_modes({"all=off", "nerf=on", "cont=off", "cont=auto"});
  CHECK(modes.size() == effect_registry().size());
  CHECK(modes.at("nerf") == EffectMode::kOn);
  CHECK(modes.at("cont") == EffectMode::kAuto);
  CHECK(modes.at("contours") == EffectMode::kOff);
  CHECK(effect_modes({}).empty());
  for (const char* wrong : {"nerf", "nerv=on", "nerf=yes", "=on", "", "all"})
    CHECK_THROWS_AS(effect_modes({wrong}), Error);
}

TEST_CASE(
    "decisions: an entry wins over a verdict, a verdict over the detector, and a need that is off over "
    "that") {
  const EffectCase c;
  Monitor monitor;
  JointOptions joint = c.joint;
  joint.effect = {"sh=on", "contours=off"};
  const Problem in = c.input();
  const EffectSetup setup{joint, c.edge, c.sample, c.rbf, in};
  const auto all = decide_effects({}, monitor, setup, EffectPhase::kSteps,
                                  {{"sh", false, "because"},
                                   {"cont", false, "because", "replayed"},
                                   {"nerf", false, "too"},
                                   {"joint", true, "so"}},
                                  {});
  for (const EffectDecision& d : all) {
    CAPTURE(d.effect->name);
    if (d.effect->name == "sh") CHECK((d.on && d.mode == "on"));
    if (d.effect->name == "cont") CHECK((!d.on && d.mode == "replayed" && d.reason == "because"));
    if (d.effect->name == "smooth") CHECK((!d.on && d.reason == "needs nerf"));
  }
}

TEST_CASE(
    "the registry says what every effect is, what off saves, and why it is always on or has its threshold") {
  for (const EffectInfo& e : effect_registry()) {
    CAPTURE(e.name);
    CHECK_FALSE(e.help.empty());
    CHECK(find_effect(e.name) == &e);
    if (!e.needs.empty()) CHECK(find_effect(e.needs) < &e);  // decided before
    CHECK_FALSE(e.why.empty());
    if (e.on == OnWhere::kAlways) continue;
    CHECK_FALSE(e.saves.empty());
    CHECK_FALSE(e.measured.empty());
    CHECK(e.measure != nullptr);
  }
}

}  // namespace ngs
