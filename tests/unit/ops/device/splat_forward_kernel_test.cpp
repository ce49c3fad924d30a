#include "ngs/ops/device/splat_forward_kernel.h"

#include <doctest/doctest.h>

#include "support/random.h"

namespace ngs {

// The emulation runs one block after the other, so it cannot detect tiles that share rows.
TEST_CASE("splat forward kernel: tiles store their checkpoints in disjoint rows within the allocation") {
  test::Random random(3);
  for (int draw = 0; draw < 200; ++draw) {
    std::int64_t begin = 0, free_row = 0;
    const std::int64_t tiles = 1 + random.below(20);
    for (std::int64_t tile = 0; tile < tiles; ++tile) {
      const std::int64_t entries = random.below(2) == 0 ? random.below(3) : random.below(4 * Checkpoints::kEntries);
      const std::int64_t first = Checkpoints::first_row(begin, tile);
      if (entries > 0) {
        CHECK(first >= free_row);
        free_row = first + ceil_div<std::int64_t>(entries, Checkpoints::kEntries);
      }
      begin += entries;
    }
    CHECK(free_row <= Checkpoints::rows(begin, tiles));
  }
}

}  // namespace ngs
