#include "ngs/cut/passes/floaters/floaters.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "ngs/problem/cloud_rows.h"
#include "ngs/problem/view_list.h"
#include "support/changed_labels.h"
#include "support/joint_case.h"

namespace ngs {
namespace {

constexpr std::int64_t kBall = 160, kWall = 120, kAdded = test::kBeforeBall;

/// The joint case with view 0 held out and Gaussians added in front of its ball; `real`: the photos show them.
struct FloaterCase {
  std::unique_ptr<test::JointCase> base = test::joint_case(int(kBall), int(kWall));
  std::vector<std::size_t> mask_reads;

  explicit FloaterCase(bool real, bool nothing_added = false) {
    base->model = base->truth;
    if (!nothing_added) test::add_before_ball(base->scene.views[0].camera, base->model);
    for (std::size_t v = 0; v < 4; ++v) {
      base->scene.views[v].image_path = "photo";
      if (real) base->photos[v] = render({}, base->model, base->scene.views[v].camera, {}, {}).colour;
    }
    base->scene.views[0].split = Split::kHeldOut;
    const auto load = [&](std::size_t v) { return base->masks[v]; };
    base->rule = {};
    base->labels = label_gaussians(
        base->rule, accumulate_evidence({}, test::Quiet(), {base->model, base->scene, {1, 2, 3}, {}, load}));
  }
  Problem input() {
    Problem in = base->input();
    in.views = {1, 2, 3};
    in.load_masks = [this](std::size_t v) {
      mask_reads.push_back(v);
      return base->masks[v];
    };
    return in;
  }
  FloaterFinding find(int threads = 1) { return find_floaters({.threads = threads}, test::Quiet(), {}, input()); }
};

/// Share of the ball's true pixels that the rendered mask of view 0 shows.
double recall_of_view_0(const FloaterCase& c, const GaussianCloud& cloud, const LabelColumns& labels) {
  RenderRequest request{.colour = false, .label = {}};
  const std::vector<float> label = labels.label.values();
  request.label = {label.data(), cloud.size(), 1};
  const RenderedView view = render({}, cloud, c.base->scene.views[0].camera, {}, request);
  double hit = 0, all = 0;
  for (std::size_t p = 0; p < view.label.data.size(); ++p) {
    if (c.base->masks[0].target[0][p] < 0.5f) continue;
    all += 1;
    hit += view.label.data[p] > 0.5f;
  }
  return hit / all;
}

}  // namespace

TEST_CASE("floaters in front of the object, and no other Gaussians, are found from photos alone") {
  FloaterCase c(false);
  const FloaterFinding finding = c.find();
  CHECK(finding.count == kAdded);
  for (std::int64_t i = 0; i < c.base->model.size(); ++i) {
    CAPTURE(i);
    CHECK(bool(finding.floater[std::size_t(i)]) == (i >= kBall + kWall));
  }
  for (const std::size_t v : c.mask_reads) CHECK(v != 0);
  CHECK(finding.figures.at("core") > 50);
  CHECK(finding.floater == c.find(3).floater);
}

TEST_CASE("the same floaters are found if the core is a small part of the model") {
  FloaterCase c(false);
  const FloaterFinding few = c.find();
  const auto n = std::size_t(c.base->model.size());
  REQUIRE(8 * few.figures.at("core") > double(n));
  GaussianCloud large = c.base->model;
  const std::size_t m = 20 * n;
  large.resize(std::int64_t(m), large.sh_degree);
  std::fill(large.usable.begin() + std::ptrdiff_t(n), large.usable.end(), std::uint8_t(0));  // not rendered
  c.base->model = large;
  for (const auto column : kLabelColumns) {
    std::vector<float> values = (c.base->labels[0].*column).values();
    values.resize(m, 0.f);
    c.base->labels[0].*column = LabelColumn(values);
  }
  const FloaterFinding many = c.find(2);
  CHECK(many.count == few.count);
  CHECK(std::equal(few.floater.begin(), few.floater.end(), many.floater.begin()));
  for (const char* figure : {"core", "hidden", "noise", "margin", "candidates"}) {
    INFO(std::string(figure));
    CHECK(many.figures.at(figure) == few.figures.at(figure));
  }
}

TEST_CASE("Gaussians that the photos show in front of the object are no floaters") {
  FloaterCase c(true);
  CHECK(c.find().count == 0);
}

TEST_CASE("a model without floaters loses no Gaussian") {
  FloaterCase c(false, true);
  CHECK(c.find().count == 0);
}

TEST_CASE("a pixel that the mask labels background never counts, whatever the photo shows") {
  FloaterCase c(false);
  Problem in = c.input();
  in.views = {0, 1, 2, 3};
  ViewMasks nothing = c.base->masks[0];
  std::fill(nothing.target[0].begin(), nothing.target[0].end(), 0.f);
  in.load_masks = [&](std::size_t v) { return v == 0 ? nothing : c.base->masks[v]; };
  // View 1 shows some of them in front of the ball's rim, so some are still found.
  CHECK(find_floaters({}, test::Quiet(), {}, in).count < kAdded / 2);
}

TEST_CASE("floaters that hide less than min_hidden stay, and the figures have the hidden share") {
  FloaterCase c(false);
  const FloaterFinding all = c.find();
  REQUIRE(all.count > 0);
  const double hidden = all.figures.at("hidden");
  CHECK(hidden > 1e-3);
  CHECK(hidden < 1);
  CHECK(find_floaters({}, test::Quiet(), {.min_hidden = 0.99 * hidden}, c.input()).count == all.count);
  CHECK(find_floaters({}, test::Quiet(), {.min_hidden = 1.01 * hidden}, c.input()).count == 0);
}

TEST_CASE("a hand-fixed Gaussian is never a floater") {
  FloaterCase c(false);
  Problem in = c.input();
  in.fixed.assign(std::size_t(c.base->model.size()), 0.f);
  in.fixed[std::size_t(kBall + kWall)] = 1.f;
  const FloaterFinding finding = find_floaters({}, test::Quiet(), {}, in);
  CHECK(finding.floater[std::size_t(kBall + kWall)] == 0);
  CHECK(finding.count > 0);
}

TEST_CASE("no floater is found without a core, without photos or without Gaussians") {
  FloaterCase c(false);
  test::change(c.base->labels[0].prob, [](float p) { return std::min(p, 0.5f); });
  CHECK(c.find().count == 0);
  FloaterCase blind(false);
  for (SceneView& v : blind.base->scene.views) v.image_path.clear();
  CHECK(blind.find().count == 0);
  FloaterCase empty(false, true);
  empty.base->model.resize(0, 1);
  empty.base->labels = label_gaussians({}, Evidence(0, 1));
  CHECK(empty.find().count == 0);
}

TEST_CASE("removal uncovers the object, keeps every row and reports the photos' PSNR") {
  FloaterCase c(false);
  const FloaterFinding finding = c.find();
  const FloaterRemoval out = remove_floaters({}, test::Quiet(), {.epochs = 2}, c.input(), finding);
  const std::vector<LabelColumns> labels =
      labels_without_floaters({}, test::Quiet(), c.input(), out.cloud, finding.floater);
  REQUIRE(out.cloud.size() == c.base->model.size());
  for (std::size_t i = 0; i < finding.floater.size(); ++i) {
    if (!finding.floater[i]) continue;
    CHECK(out.cloud.logit_opacity[i] == kRemovedLogit);
    CHECK(labels[0].label[i] == 0);
    CHECK(labels[0].views[i] == c.base->labels[0].views[i]);
  }
  const double before = recall_of_view_0(c, c.base->model, c.base->labels[0]);
  const double after = recall_of_view_0(c, out.cloud, labels[0]);
  CAPTURE(before);
  CHECK(before < 0.85);
  CHECK(after > 0.97);
  CHECK(out.figures.at("psnr_removed_db") > out.figures.at("psnr_before_db"));
  CHECK(out.figures.at("psnr_after_db") > out.figures.at("psnr_before_db"));
}

TEST_CASE("a refit does not depend on Gaussians outside all views to the bit, and does not change them") {
  const auto c = test::joint_case();
  for (SceneView& v : c->scene.views) v.image_path = "photo";
  const Problem in = c->input();
  const std::vector<std::size_t> views = photo_views(c->scene);
  const auto n = std::size_t(c->model.size());
  GaussianCloud alone = c->model;
  refit_to_photos({}, test::Quiet(), {.epochs = 2},
                  {in, views, std::vector<std::uint8_t>(n, 1), std::vector<std::uint8_t>(n, 1)}, alone);
  CHECK(alone.sh_dc != c->model.sh_dc);
  // Every other row is a copy that lies far behind all cameras.
  const auto more = test::joint_case();
  more->scene = c->scene;
  std::vector<std::int64_t> twice;
  for (std::size_t i = 0; i < n; ++i) twice.insert(twice.end(), 2, std::int64_t(i));
  GaussianCloud& model = more->model = gather_rows({}, c->model, twice);
  for (std::size_t i = 0; i < n; ++i) model.position[3 * (2 * i + 1) + 1] += 1e4f;
  GaussianCloud both = model;
  const std::vector<std::uint8_t> all(2 * n, 1);
  refit_to_photos({}, test::Quiet(), {.epochs = 2}, {more->input(), views, all, all}, both);
  std::vector<std::int64_t> seen, unseen;
  for (std::size_t i = 0; i < n; ++i) {
    seen.push_back(std::int64_t(2 * i));
    unseen.push_back(std::int64_t(2 * i + 1));
  }
  const GaussianCloud got = gather_rows({}, both, seen), left = gather_rows({}, both, unseen),
                      given = gather_rows({}, model, unseen);
  CHECK(got.sh_dc == alone.sh_dc);
  CHECK(got.position == alone.position);
  CHECK(got.logit_opacity == alone.logit_opacity);
  CHECK(left.sh_dc == given.sh_dc);
  CHECK(left.position == given.position);
}

TEST_CASE("a refit moves only the rows that may move, and recovers a shifted colour") {
  const auto c = test::joint_case();
  for (SceneView& v : c->scene.views) v.image_path = "photo";
  Problem in = c->input();
  std::vector<std::uint8_t> moves(std::size_t(c->model.size()), 0);
  for (std::size_t i = std::size_t(kBall); i < moves.size(); ++i) moves[i] = 1;
  GaussianCloud cloud = c->model;
  const std::vector<std::size_t> views = photo_views(c->scene);
  REQUIRE(views.size() == 4);
  refit_to_photos({}, test::Quiet(), {.epochs = 8}, {in, views, moves, std::vector<std::uint8_t>(moves.size(), 1)},
                  cloud);
  CHECK(mean_psnr_db({}, in, cloud, views) > mean_psnr_db({}, in, c->model, views) + 1);
  double moved = 0;
  for (std::size_t i = 0; i < moves.size(); ++i)
    for (std::size_t a = 0; a < 3; ++a) {
      const double d = std::abs(double(cloud.position[3 * i + a]) - double(c->model.position[3 * i + a]));
      if (moves[i])
        moved += d;
      else
        CHECK(d == 0);
    }
  CHECK(moved > 0);
}

TEST_CASE("a refit leaves rows that are not trained bit-identical") {
  const auto c = test::joint_case();
  for (SceneView& v : c->scene.views) v.image_path = "photo";
  const Problem in = c->input();
  const auto n = std::size_t(c->model.size());
  std::vector<std::uint8_t> trained(n, 0);
  for (std::size_t i = 0; i < n; i += 3) trained[i] = 1;
  GaussianCloud cloud = c->model;
  refit_to_photos({}, test::Quiet(), {.epochs = 2},
                  {in, photo_views(c->scene), std::vector<std::uint8_t>(n, 1), trained}, cloud);
  std::size_t changed = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const bool same = std::equal(&cloud.sh_dc[3 * i], &cloud.sh_dc[3 * i] + 3, &c->model.sh_dc[3 * i]) &&
                      std::equal(&cloud.position[3 * i], &cloud.position[3 * i] + 3, &c->model.position[3 * i]);
    if (!trained[i]) CHECK(same);
    changed += !same;
  }
  CHECK(changed > n / 6);
}

}  // namespace ngs
