#include "ngs/cut/passes/mask_outliers/mask_outliers.h"

#include <doctest/doctest.h>

#include "support/joint_case.h"
#include "support/splat_shapes.h"

namespace ngs {
namespace {

/// Six views: the four of the joint case, and its first two again. Masks can be replaced by wrong ones.
struct MaskOutlierCase {
  std::unique_ptr<test::JointCase> base = test::joint_case();
  MaskOutlierCase() {
    base->model = base->truth;
    for (std::size_t v = 0; v < 2; ++v) {
      base->scene.views.push_back(base->scene.views[v]);
      base->masks.push_back(base->masks[v]);
    }
  }
  Problem input() const {
    Problem in = base->input();
    in.views = {0, 1, 2, 3, 4, 5};
    return in;
  }
  MaskOutliers find(int threads = 1) const { return find_mask_outliers({.threads = threads}, test::Quiet(), input()); }
  void mirror(std::size_t view) {
    ViewMasks& m = base->masks[view];
    for (std::size_t row = 0; row < 40; ++row)
      std::reverse(m.target[0].begin() + std::ptrdiff_t(row * 48), m.target[0].begin() + std::ptrdiff_t(row * 48 + 48));
    std::rotate(m.target[0].begin(), m.target[0].begin() + 480 + 14, m.target[0].end());
  }
};

}  // namespace

TEST_CASE("masks that agree hold no outlier") {
  const MaskOutlierCase c;
  const MaskOutliers found = c.find();
  CHECK(found.ignored.empty());
  for (const double d : found.disagreement) CHECK(d < 0.2);
  CHECK(found.figures.at("threshold") >= 0.2);
}

TEST_CASE("a view whose mask covers other pixels is an outlier, the other views are not") {
  MaskOutlierCase c;
  c.mirror(4);
  const MaskOutliers found = c.find();
  REQUIRE(found.ignored.size() == 1);
  CHECK(found.ignored[0] == 4);
  CHECK(found.disagreement[4] > 0.5);
  CHECK_FALSE(consistent_masks(found, 4, c.base->masks[4]).available);
  CHECK(consistent_masks(found, 3, c.base->masks[3]).available);
  CHECK(c.find(3).disagreement == found.disagreement);
}

TEST_CASE("an empty mask is an outlier if the others show the object") {
  MaskOutlierCase c;
  std::fill(c.base->masks[2].target[0].begin(), c.base->masks[2].target[0].end(), 0.f);
  const MaskOutliers found = c.find();
  REQUIRE(found.ignored.size() == 1);
  CHECK(found.ignored[0] == 2);
}

TEST_CASE("wrong masks are found however much they raise the deviation") {
  double median = 0;
  const std::vector<double> third_wrong = {0.07, 0.11, 0.16, 0.2, 0.22, 0.38, 1, 1, 1};
  CHECK(ignore_threshold(third_wrong, median) < 1);
  CHECK(median == 0.22);
  CHECK(ignore_threshold(third_wrong, median) > 0.38);
  // If the median exceeds a half, no mask is an outlier.
  CHECK(ignore_threshold(std::vector<double>{0.3, 0.5, 0.6, 0.8, 1}, median) > 1);
}

TEST_CASE("views that do not see the object do not enter the median") {
  MaskOutlierCase c;
  for (std::size_t v = 0; v < 6; ++v) {  // every mask is shifted by 2 px, left or right
    std::vector<float>& mask = c.base->masks[v].target[0];
    std::rotate(mask.begin(), v % 2 == 0 ? mask.begin() + 2 : mask.end() - 2, mask.end());
  }
  const MaskOutliers few = c.find();
  CHECK(few.ignored.empty());
  CHECK(few.figures.at("median_disagreement") > 0.15);

  Problem in = c.input();
  for (int more = 0; more < 20; ++more) in.views.push_back(c.base->add_empty_view());
  const MaskOutliers many = find_mask_outliers({}, test::Quiet(), in);
  CHECK(many.ignored.empty());
  CHECK(many.figures.at("median_disagreement") == few.figures.at("median_disagreement"));
  for (std::size_t n = 0; n < in.views.size(); ++n) CHECK(many.disagreement[n] == (n < 6 ? few.disagreement[n] : 0));

  c.mirror(4);  // a wrong mask is still found
  const MaskOutliers one = find_mask_outliers({}, test::Quiet(), in);
  REQUIRE(one.ignored.size() == 1);
  CHECK(one.ignored[0] == 4);
}

TEST_CASE("no mask is an outlier if fewer than four show the object, however many are empty") {
  MaskOutlierCase c;
  Problem in = c.input();
  in.views = {0, 1, 2};
  c.mirror(0);
  for (int more = 0; more < 5; ++more) in.views.push_back(c.base->add_empty_view());
  CHECK(find_mask_outliers({}, test::Quiet(), in).ignored.empty());
}

TEST_CASE("one wrong mask of four is an outlier, although three are too few for another round") {
  MaskOutlierCase c;
  std::fill(c.base->masks[2].target[0].begin(), c.base->masks[2].target[0].end(), 0.f);
  Problem in = c.input();
  in.views = {0, 1, 2, 3};
  const MaskOutliers found = find_mask_outliers({}, test::Quiet(), in);
  CHECK(found.ignored == std::vector<std::size_t>{2});
  CHECK(found.figures.at("rounds") == 1);
}

TEST_CASE("with fewer than four masks none is an outlier") {
  MaskOutlierCase c;
  c.mirror(0);
  for (const std::size_t v : {1u, 2u, 3u}) c.base->masks[v].available = false;
  CHECK(c.find().ignored.empty());
}

TEST_CASE("with many masks only those that fail the pretest are tested, and the outliers are the same") {
  MaskOutlierCase c;
  Problem in = c.input();
  CHECK(pretest_masks({}, in).empty());  // six views are too few for a pretest
  in.views.clear();
  for (std::size_t n = 0; n < 36; ++n) in.views.push_back(n % 6);
  const MaskOutliers agreed = find_mask_outliers({}, test::Quiet(), in, pretest_masks({}, in));
  CHECK(agreed.ignored.empty());
  CHECK(agreed.figures.at("rounds") == 0);  // no view was tested
  CHECK(agreed.figures.at("threshold") == find_mask_outliers({}, test::Quiet(), in).figures.at("threshold"));

  c.mirror(4);
  const std::vector<double> first = pretest_masks({}, in);
  REQUIRE(first.size() == 36);
  const MaskOutliers all = find_mask_outliers({}, test::Quiet(), in),
                     some = find_mask_outliers({}, test::Quiet(), in, first);
  CHECK(all.ignored == std::vector<std::size_t>(6, 4));
  CHECK(some.ignored == all.ignored);
  int kept = 0;
  for (std::size_t n = 0; n < 36; ++n) {
    if (n % 6 == 4)
      CHECK(some.disagreement[n] == all.disagreement[n]);  // against the consensus without its own mask
    else
      kept += some.disagreement[n] == std::max(first[n], 0.0);
  }
  CHECK(kept == 30);
  CHECK(pretest_masks({.threads = 3}, in) == first);
}

TEST_CASE("a mask of an object that a floater occludes is no outlier") {
  MaskOutlierCase c;  // a dark sheet occludes the ball in view 3 only
  const Vec3<double> eye = c.base->scene.views[3].camera.centre(), p = eye + 0.3 * (Vec3<double>{0, 0, 4} - eye);
  test::add_gaussian(c.base->model, p, 0.067, {}, 6);
  CHECK(c.find().ignored.empty());
}

TEST_CASE(
    "outliers: a thin object with equal disagreement in all views has none, one bad view among good ones is one") {
  CHECK(outlier_score({0.42, 0.45, 0.44, 0.47, 0.43, 0.46}) < 1);  // naive: 0.47 > 0.2
  CHECK(outlier_score({0.02, 0.03, 0.02, 0.03, 0.02, 0.15}) > 1);  // naive: 0.15 < 0.2
  CHECK(outlier_score({}) == 0);
  CHECK(outlier_score({0.9}) == 0);
}

}  // namespace ngs
