// ngs/cut/groups/mask_groups.h: by hand, on Gaussians 0-9 (object A), 10-19 (B) and 20-29 (C).
#include "ngs/cut/groups/mask_groups.h"

#include <doctest/doctest.h>

#include <functional>

#include "ngs/core/rng.h"

namespace ngs {
namespace {

constexpr int kHidden = -1;

/// A view in which Gaussian i lies in mask(i); 0: outside all, kHidden: not seen.
ViewGaussians view_of(int masks, const std::function<int(int gaussian)>& mask) {
  ViewGaussians view{masks, {}};
  for (int i = 0; i < 30; ++i)
    if (mask(i) != kHidden) view.seen.push_back({std::uint32_t(i), std::uint32_t(mask(i)), 1.f, 1.f});
  return view;
}
ViewGaussians whole(int a, int b, int c) {
  return view_of(3, [&](int i) { return i < 10 ? a : i < 20 ? b : c; });
}
const ViewGaussians kMerged = view_of(2, [](int i) { return i < 20 ? 1 : 2; });  // A and B in one mask
const ViewGaussians kDivided = view_of(4, [](int i) { return i < 5 ? 3 : i < 10 ? 1 : i < 20 ? 2 : 4; });

MaskGroups grouped(const std::vector<ViewGaussians>& views, const GroupOptions& options = {}, int threads = 1) {
  return group_masks({.threads = threads}, options, views);
}

}  // namespace

TEST_CASE("masks of three objects with ids that differ between the views make three groups") {
  const MaskGroups found = grouped({whole(1, 2, 3), whole(3, 1, 2), whole(2, 3, 1), whole(1, 2, 3)});
  REQUIRE(found.groups() == 3);
  CHECK(found.views == std::vector<int>{4, 4, 4});
  CHECK(found.group[0] == std::vector<std::int32_t>{0, 1, 2});
  CHECK(found.group[1] == std::vector<std::int32_t>{1, 2, 0});
  CHECK(found.group[2] == std::vector<std::int32_t>{2, 0, 1});
}

TEST_CASE("a mask that covers two objects is dropped if the other views split it, and joins nothing") {
  const MaskGroups found = grouped({whole(1, 2, 3), kMerged, whole(2, 1, 3), whole(1, 2, 3)});
  REQUIRE(found.groups() == 3);
  CHECK(found.group[1] == std::vector<std::int32_t>{MaskGroups::kDropped, 2});
  CHECK(found.group[0] == std::vector<std::int32_t>{0, 1, 2});
  GroupOptions naive;  // a mask of several objects is kept, and one common view joins
  naive.split = 1;
  naive.consensus = 0;
  naive.min_observers = 1;
  CHECK(grouped({whole(1, 2, 3), kMerged, whole(2, 1, 3), whole(1, 2, 3)}, naive).groups() == 2);
}

TEST_CASE("the parts of an object that one view divides join the masks that contain both") {
  const MaskGroups found = grouped({whole(1, 2, 3), kDivided, whole(2, 1, 3), whole(1, 2, 3), whole(3, 2, 1)});
  REQUIRE(found.groups() == 3);
  CHECK(found.group[1] == std::vector<std::int32_t>{0, 1, 0, 2});
}

TEST_CASE("two parts that most views have in two masks stay two objects") {
  const MaskGroups found = grouped({kDivided, kDivided, kDivided, whole(1, 2, 3)});
  CHECK(found.group[0] == std::vector<std::int32_t>{0, 1, 2, 3});
  CHECK(found.group[3] == std::vector<std::int32_t>{MaskGroups::kDropped, 1, 3});
}

TEST_CASE("a mask of Gaussians that no other view sees is a group of its own view") {
  const auto without_c = [](int i) { return i < 10 ? 1 : i < 20 ? 2 : kHidden; };
  const MaskGroups found = grouped({whole(1, 2, 3), view_of(2, without_c), view_of(2, without_c)});
  REQUIRE(found.groups() == 3);
  CHECK(found.views == std::vector<int>{3, 3, 1});
}

TEST_CASE("views that show opposite sides of an object are joined through views of both") {
  const auto sees = [](int first, int last) {
    return view_of(1, [=](int i) { return i >= first && i < last ? 1 : kHidden; });
  };
  const std::vector<ViewGaussians> ring = {sees(0, 10), sees(0, 10),  sees(5, 15),
                                           sees(5, 15), sees(10, 20), sees(10, 20)};
  CHECK(grouped(ring).groups() == 1);
  CHECK(grouped({ring[0], ring[1], ring[4], ring[5]}).groups() == 2);
}

TEST_CASE("a mask of which a view sees less than `visible` is not observed by it") {
  const auto part = [](int count) { return view_of(1, [=](int i) { return i < count ? 1 : kHidden; }); };
  GroupOptions options{.min_observers = 1};
  CHECK(grouped({part(10), part(3)}, options).groups() == 1);
  CHECK(grouped({part(10), part(2)}, options).groups() == 1);  // the second's mask is seen whole by the first
  options.min_observers = 2;                                   // needs that the second observes the first
  CHECK(grouped({part(10), part(3)}, options).groups() == 1);
  CHECK(grouped({part(10), part(2)}, options).groups() == 2);
}

TEST_CASE("no views, one view, views without masks and masks without Gaussians are defined") {
  CHECK(grouped({}).groups() == 0);
  CHECK(grouped({whole(1, 2, 3)}).groups() == 3);
  CHECK(grouped({ViewGaussians{}, ViewGaussians{}}).groups() == 0);
  const MaskGroups found = grouped({whole(1, 2, 3), ViewGaussians{}, ViewGaussians{2, {}}, whole(1, 2, 3)});
  CHECK(found.groups() == 5);  // both masks without Gaussians are groups of their own
  CHECK(found.group[1].empty());
  CHECK(found.group[3] == std::vector<std::int32_t>{0, 1, 2});
}

TEST_CASE("the groups of noisy masks are the same for any number of threads") {
  std::vector<ViewGaussians> views;
  for (std::uint64_t v = 0; v < 25; ++v)
    views.push_back(view_of(6, [&](int i) {
      const double u = rng_uniform(7, RngStream::kTest, v * 64 + std::uint64_t(i));
      return u < 0.2 ? kHidden : u < 0.3 ? int(20 * u) : 1 + (i / 10 + int(v)) % 6;
    }));
  const MaskGroups one = grouped(views);
  REQUIRE(one.groups() > 2);
  for (const int threads : {2, 5}) {
    CAPTURE(threads);
    const MaskGroups several = grouped(views, {}, threads);
    CHECK(several.group == one.group);
    CHECK(several.views == one.views);
  }
}

}  // namespace ngs
