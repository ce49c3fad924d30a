// Device against CPU: the part of a view in front of a surface.
#include "ngs/ops/splat/front_layer.h"
#include "parity/backends.h"
#include "support/random.h"
#include "support/splat_reference.h"

namespace ngs::test {

TEST_CASE("front view of a device equals the CPU's, bit by bit with its functions") {
  for (const Backend& b : backends())
    for (const int gaussians : {0, 1, 60, 700})
      for (const int columns : {0, 2, 4, 7}) {  // 7: two launches
        const SplatCase c = splat_case(std::uint64_t(gaussians) + 5, gaussians, 53, 41, gaussians == 700 ? 0.2 : 1.0);
        const GaussianCloud cloud = float_cloud(c);
        Random random(3);
        ImageF limit(53, 41, 1);
        std::vector<std::uint8_t> marked;
        for (float& z : limit.data) {
          z = random.below(7) == 0 ? 0.f : float(random.uniform(1.5, 7));  // the depths lie in 1.5 to 6
          marked.push_back(random.below(3) == 0);
        }
        Candidates candidate;
        for (int i = 0; i < gaussians; ++i) candidate.push_back(random.below(4) != 0);
        const RowNumbers of(candidate);
        const auto value = random.uniform_vector<float>(std::size_t(of.size() * columns), 0, 1);
        const auto layer = [&](const FrontView& view) {
          return columns > 0 ? view.layer({of, {value.data(), of.size(), columns}}) : view.layer(candidate);
        };
        const FrontView want({}, cloud, limit, c.camera, {}), got(b.exec, cloud, limit, c.camera, {});
        const ImageF want_layer = layer(want), got_layer = layer(got);
        ViewSums want_sums = want.sums(candidate, marked), got_sums = got.sums(candidate, marked);
        CAPTURE(gaussians);
        CAPTURE(columns);
        check_ratio(b, "front layer", worst_ratio(got_layer.data, want_layer.data, 1.0), 100);
        const auto by_row = [&](const ViewSums& sums) {
          std::vector<double> all(std::size_t(2 * gaussians));
          for (std::size_t v = 0; v < sums.size(); ++v)
            all[2 * sums.row[v]] = sums.weight(v), all[2 * sums.row[v] + 1] = sums.object_weight(v, 0);
          return all;
        };
        const std::vector<double> sums = by_row(want_sums);
        check_ratio(b, "front sums", worst_ratio(by_row(got_sums), sums, std::max(largest(sums), 1.0)), 500);
        if (gaussians == 700) CHECK(largest(sums) > 1);
        if (!b.same_functions) continue;
        CHECK(got_layer.data == want_layer.data);
        CHECK(by_row(got_sums) == sums);
      }
}

}  // namespace ngs::test
