#pragma once
// Which Gaussians a run has changed, and whether two runs have changed them alike.
#include <doctest/doctest.h>

#include <bit>
#include <cstdint>
#include <vector>

#include "ngs/make/fit/fit_density.h"

namespace ngs::test {

/// [rows of `now`] 1: some trained value of the row has other bytes than its source row of `before`. `source_row`
/// empty: the same rows.
inline std::vector<std::uint8_t> changed_rows(const GaussianCloud& now, const GaussianCloud& before,
                                              const std::vector<std::int64_t>& source_row = {}) {
  std::vector<std::uint8_t> changed(std::size_t(now.size()), 0);
  REQUIRE((source_row.empty() ? before.size() : std::int64_t(source_row.size())) == now.size());
  for (std::size_t g = 0; g < kGaussianGroups; ++g) {
    const auto width = std::size_t(group_width(before, g));
    const std::vector<float>&a = now.*kGroupColumns[g].value, &b = before.*kGroupColumns[g].value;
    for (std::size_t i = 0; i < changed.size() * width; ++i) {
      const std::size_t row = i / width, source = source_row.empty() ? row : std::size_t(source_row[row]);
      if (std::bit_cast<std::uint32_t>(a[i]) != std::bit_cast<std::uint32_t>(b[source * width + i % width]))
        changed[row] = 1;
    }
  }
  return changed;
}

inline void check_same_bits(const GaussianCloud& got, const GaussianCloud& want) {
  CHECK(got.position == want.position);
  CHECK(got.rotation == want.rotation);
  CHECK(got.log_scale == want.log_scale);
  CHECK(got.logit_opacity == want.logit_opacity);
  CHECK(got.sh_dc == want.sh_dc);
  CHECK(got.sh_rest == want.sh_rest);
}

}  // namespace ngs::test
