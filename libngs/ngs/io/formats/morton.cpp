#include "ngs/io/formats/morton.h"

#include "ngs/math/curve_order.h"

namespace ngs::io {

SplatSelection along_morton_curve(const SplatSelection& model) {
  std::vector<float> points;
  for (const std::int64_t i : model.rows)
    points.insert(points.end(), &model.cloud.position[std::size_t(i) * 3],
                  &model.cloud.position[std::size_t(i) * 3] + 3);
  SplatSelection sorted{model.cloud, {}, model.left_out, model.shift};
  for (const std::uint32_t k : curve_order(points)) sorted.rows.push_back(model.rows[k]);
  return sorted;
}

}  // namespace ngs::io
