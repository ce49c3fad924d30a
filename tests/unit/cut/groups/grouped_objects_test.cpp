// ngs/cut/groups/grouped_objects.h: votes and figures by hand, Gaussians 0-19 (object A) and 20-29 (B).
#include "ngs/cut/groups/grouped_objects.h"

#include <doctest/doctest.h>

#include <algorithm>

namespace ngs {
namespace {

/// Gaussian i lies in mask[i / 10] with weight 1.
ViewGaussians view_of(int masks, std::vector<std::uint32_t> mask) {
  ViewGaussians view{masks, {}};
  for (std::uint32_t i = 0; i < 30; ++i) view.seen.push_back({i, mask[i / 10], 1.f, 1.f});
  return view;
}
std::vector<ViewGaussians> views_of_both(int count) {
  return std::vector<ViewGaussians>(std::size_t(count), view_of(2, {1, 1, 2}));
}
GroupedObjects found_in(const std::vector<ViewGaussians>& views, const ObjectOptions& options = {}) {
  const Exec exec;
  return objects_of_groups(exec, options, 31, views, group_masks(exec, {}, views));
}

}  // namespace

TEST_CASE("objects are numbered by size, and a Gaussian that no view sees has none") {
  std::vector<ViewGaussians> views(4, view_of(2, {1, 2, 2}));  // the second mask is the larger one
  const GroupedObjects found = found_in(views);
  REQUIRE(found.sure == 2);
  CHECK(found.objects[0].gaussians == 20);
  CHECK(found.objects[0].confidence == 1);
  CHECK(found.objects[0].views.size() == 4);
  CHECK(found.object[0] == 2);
  CHECK(found.object[10] == 1);
  CHECK(found.object[30] == 0);
}

TEST_CASE("a Gaussian gets the object that most views show it in") {
  std::vector<ViewGaussians> views = views_of_both(5);
  for (std::size_t v : {0u, 1u}) views[v].seen[3].mask = 2;      // 2 of 5 views
  for (std::size_t v : {0u, 1u, 2u}) views[v].seen[4].mask = 2;  // 3 of 5
  for (std::size_t v : {2u, 3u, 4u}) views[v].seen[5].mask = 0;
  const GroupedObjects found = found_in(views);
  REQUIRE(found.sure == 2);
  CHECK(found.object[3] == 1);
  CHECK(found.object[4] == 2);
  CHECK(found.object[5] == 0);
}

TEST_CASE("an object of too few views or Gaussians is doubtful, behind the sure ones") {
  std::vector<ViewGaussians> views = views_of_both(4);
  ObjectOptions options;
  options.min_gaussians = 11;
  const GroupedObjects small = found_in(views, options);
  CHECK(small.sure == 1);
  REQUIRE(small.objects.size() == 2);
  CHECK(small.objects[1].gaussians == 10);
  CHECK(small.object[25] == 2);
  options.min_views = 5;
  CHECK(found_in(views, options).sure == 0);
  CHECK(found_in({}).objects.empty());
}

TEST_CASE("five hundred objects, numbered differently in each view, are found") {
  constexpr std::uint32_t kObjects = 500, kEach = 10;
  std::vector<ViewGaussians> views(4, ViewGaussians{int(kObjects), {}});
  for (std::uint32_t v = 0; v < views.size(); ++v)
    for (std::uint32_t i = 0; i < kObjects * kEach; ++i)
      views[v].seen.push_back({i, 1 + (7 * (i / kEach) + 131 * v) % kObjects, 1.f, 1.f});
  const Exec exec;
  const GroupedObjects found = objects_of_groups(exec, {}, kObjects * kEach, views, group_masks(exec, {}, views));
  REQUIRE(found.sure == kObjects);
  std::vector<std::uint32_t> first(kObjects + 1);
  for (std::uint32_t i = 0; i < kObjects * kEach; ++i) {
    REQUIRE(found.object[i] > 0);
    CHECK(found.object[i] == found.object[i - i % kEach]);
    if (i % kEach == 0) ++first[found.object[i]];
  }
  CHECK(std::ranges::count(first, 1u) == kObjects);
}

TEST_CASE("an object that some views have in the mask of another is part of it") {
  std::vector<ViewGaussians> views = views_of_both(5);
  for (std::size_t v : {0u, 1u}) {
    views[v].masks = 1;
    for (MaskedGaussian& of : views[v].seen) of.mask = 1;
  }
  const GroupedObjects found = found_in(views);
  REQUIRE(found.sure == 2);
  CHECK(found.objects[1].part_of == 1);
  CHECK(found.objects[1].part_share == doctest::Approx(0.4));
  CHECK(found.objects[1].confidence == doctest::Approx(0.6));
  CHECK(found.objects[0].part_of == 0);
}

TEST_CASE("the content of a mask is the object with most of its weight") {
  std::vector<ViewGaussians> views = views_of_both(4);
  const GroupedObjects found = found_in(views);
  const ViewGaussians one = view_of(2, {1, 0, 1});
  const std::vector<MaskContent> content = mask_contents(one, found);
  REQUIRE(content.size() == 3);
  CHECK(content[1].share == doctest::Approx(0.5));
  CHECK(content[0].object == 1);
  CHECK(content[0].share == 1);
  CHECK_FALSE(content[2].is_known);
}

}  // namespace ngs
