// The 3D filter of Mip-Splatting and its successors, whose PLYs hold scales and opacities before filtering.
#include <cmath>

#include "ngs/io/ply/gaussian_columns.h"
#include "ngs/io/ply/selected_columns.h"
#include "ngs/math/stable.h"

namespace ngs::io {
namespace {

/// Computes ln √(s² + f²) from ln s and ln f.
double filtered_log_scale(double log_scale, double log_filter) {
  return log_scale + 0.5 * softplus(2 * (log_filter - log_scale));
}

/// The logit of c σ(x), with ln c = -loss <= 0, without rounding σ(x) or c to 0 or 1 in between.
double fainter_logit(double x, double loss) { return -loss - std::log(std::exp(-x) + one_minus_exp(loss)); }

}  // namespace

bool has_3d_filter(const PlyTable& rows) { return rows.find(kFilter3dColumn) >= 0; }

PlyTable fuse_3d_filter(const PlyTable& rows) {
  PlyTable fused = copy_of(rows, {rows, [](const std::string& name) { return name != kFilter3dColumn; }});
  struct Field {
    PlyColumn column;
    std::size_t offset;
  };
  const auto store = [&](const Field& to, std::int64_t i, double value) {
    ply_store(to.column.type, value, fused.owned.data() + std::size_t(i) * fused.row_bytes + to.offset);
  };
  std::vector<Field> scales, opacities;
  for (std::size_t p = 0; p < fused.properties.size(); ++p) {
    const std::string& name = fused.properties[p].name;
    if (name == "opacity") opacities.push_back({fused.column(name), fused.offset[p]});
    if (name == "scale_0" || name == "scale_1" || name == "scale_2")
      scales.push_back({fused.column(name), fused.offset[p]});
  }
  const PlyColumn filter = rows.column(kFilter3dColumn);
  for (std::int64_t i = 0; i < rows.rows; ++i) {
    const double width = std::abs(filter.value(i));
    if (width == 0) continue;
    double loss = 0;
    for (const Field& scale : scales) {
      const double before = scale.column.value(i), after = filtered_log_scale(before, std::log(width));
      loss += after - before;
      store(scale, i, after);
    }
    for (const Field& opacity : opacities) store(opacity, i, fainter_logit(opacity.column.value(i), loss));
  }
  return fused;
}

}  // namespace ngs::io
