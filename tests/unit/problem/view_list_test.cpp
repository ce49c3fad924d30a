#include "ngs/problem/view_list.h"

#include <doctest/doctest.h>

namespace ngs {

TEST_CASE("spread_views returns distinct views, evenly spread, at most as many as there are") {
  using List = std::vector<std::size_t>;
  CHECK(spread_views({}, 3).empty());
  CHECK(spread_views({4, 7}, 3) == List{4, 7});
  CHECK(spread_views({4, 7, 9}, 3) == List{4, 7, 9});
  CHECK(spread_views({0, 1, 2, 3, 4, 5, 6}, 3) == List{0, 2, 4});
}

}  // namespace ngs
