// Positions far from 0: double columns are read relative to the model's centre; a comment in the file records the
// origin of relative positions.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "ngs/io/ply/gaussian_columns.h"

namespace ngs::io {
namespace {

using Origin = std::array<double, 3>;
constexpr double kFar = 8;        // half extents
constexpr double kAbsurd = 1e30;  // beyond any coordinate

struct Extent {
  Origin middle{};
  double half_side = 0, distance = 0;

  void add_axis(std::size_t axis, double low, double high) {
    middle[axis] = double(float(0.5 * (low + high)));
    half_side = std::max(half_side, 0.5 * (high - low));
    distance = std::max(distance, std::abs(0.5 * (low + high)));
  }
  bool is_far() const { return distance > kFar * half_side; }
};

}  // namespace

std::optional<Origin> far_origin(const std::array<PlyColumn, 3>& position, std::int64_t rows) {
  if (std::ranges::none_of(position, [](const PlyColumn& c) { return c.type == PlyType::kFloat64; })) return {};
  Extent all, bulk;  // both, because one distant row would hide that the others are far from 0
  for (std::size_t a = 0; a < 3; ++a) {
    std::vector<double> values;
    for (std::int64_t i = 0; i < rows; ++i)
      if (const double v = position[a].value(i); std::abs(v) < kAbsurd) values.push_back(v);
    if (values.empty()) return {};
    const auto value_at = [&](std::size_t index) {
      std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(index), values.end());
      return values[index];
    };
    const std::size_t tenth = (values.size() - 1) / 10;
    const double low = value_at(tenth), high = value_at(values.size() - 1 - tenth);
    bulk.add_axis(a, low, high);
    const auto [least, most] = std::ranges::minmax_element(values);
    all.add_axis(a, *least, *most);
  }
  if (all.is_far()) return all.middle;
  return bulk.is_far() ? std::optional(bulk.middle) : std::nullopt;
}

std::string origin_comment(const Origin& origin) {
  char text[96];
  std::snprintf(text, sizeof text, "%.17g %.17g %.17g", origin[0], origin[1], origin[2]);
  return std::string(kOriginComment) + text;
}

std::optional<Origin> origin_in(const std::vector<std::string>& comments) {
  for (const std::string& comment : comments) {
    Origin origin;
    if (!comment.starts_with(kOriginComment)) continue;
    const std::string numbers = comment.substr(kOriginComment.size());
    if (std::sscanf(numbers.c_str(), "%lf %lf %lf", &origin[0], &origin[1], &origin[2]) != 3) continue;
    if (std::ranges::all_of(origin, [](double v) { return std::abs(v) < kAbsurd; })) return origin;
  }
  return std::nullopt;
}

}  // namespace ngs::io
