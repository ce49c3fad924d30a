// What refined contours say of the masks that were given.
#include "ngs/passes/contours/refined_masks.h"

#include <doctest/doctest.h>

namespace ngs {
namespace {

/// Compared views whose refined masks agree with the given ones by `gain` more than the rendered ones did, which have
/// `beyond_px2` more than the refined ones and lack `short_px2`; `contrast`: of their contours, the refined ones' is 1.
std::vector<RefinedView> views(double gain, double contrast, double beyond_px2, double short_px2) {
  std::vector<RefinedView> some(4);
  for (std::size_t v = 0; v < some.size(); ++v) {
    some[v].compared = true;
    some[v].rendered_biou = 0.5, some[v].refined_biou = 0.5 + gain + (v % 2 == 0 ? 0.002 : -0.002);
    some[v].own_contrast = contrast, some[v].refined_contrast = 1;
    some[v].beyond_px2 = beyond_px2, some[v].short_px2 = short_px2;
  }
  return some;
}

}  // namespace

TEST_CASE("masks that lie on edges refuse what agrees with them less, whichever side they err to") {
  CHECK(masks_refuse(views(-0.01, 0.9, 10, 0)));
  CHECK(masks_refuse(views(-0.01, 0.9, 10, 10)));
  CHECK_FALSE(masks_refuse(views(-0.001, 0.9, 10, 10)));  // within twice the standard error
  CHECK_FALSE(masks_refuse(views(0.01, 0.9, 10, 10)));
}

TEST_CASE("masks beside the edges have a say only where they err to both sides alike") {
  CHECK(masks_refuse(views(-0.01, 0.5, 10, 8)));
  CHECK_FALSE(masks_refuse(views(-0.01, 0.5, 10, 1)));
  CHECK_FALSE(masks_refuse(views(-0.01, 0.5, 1, 10)));
  CHECK_FALSE(masks_refuse(views(-0.001, 0.5, 10, 8)));
}

TEST_CASE("the side is that of all views together") {
  std::vector<RefinedView> both = views(-0.01, 0.5, 10, 1);
  for (const RefinedView& other : views(-0.01, 0.5, 1, 10)) both.push_back(other);
  CHECK_FALSE(masks_err_to_one_side(both));
  CHECK(masks_err_to_one_side(views(-0.01, 0.5, 10, 1)));
}

}  // namespace ngs
