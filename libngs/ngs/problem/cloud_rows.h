#pragma once
// Adds and removes Gaussians: an edited cloud is a list of rows of the previous cloud.
#include <algorithm>
#include <cstdint>
#include <vector>

#include "ngs/backend/for_each.h"
#include "ngs/ops/optim/adam.h"
#include "ngs/scene/gaussian_cloud.h"
#include "ngs/scene/labels/label_column.h"

namespace ngs {

inline constexpr double kSplitShrink = 1.6;

/// kChild0, kChild1: the two Gaussians of a 3DGS split, with positions sampled from the parent and scales divided by
/// kSplitShrink.
/// kHalf0, kHalf1: the two halves along the longest axis, which together keep the parent's centre, covariance and
/// optical depth.
enum class RowOrigin : std::uint8_t { kKept, kClone, kChild0, kChild1, kHalf0, kHalf1 };
struct CloudRow {
  std::int64_t source;
  RowOrigin origin;
};

/// Replaces the cloud by these rows of it. `seed`: for the positions of children; must differ between calls.
void edit_rows(const Exec& exec, const std::vector<CloudRow>& rows, std::uint64_t seed, GaussianCloud& cloud);

/// The same for a column of `width` values per Gaussian.
void edit_column(const Exec& exec, const std::vector<CloudRow>& rows, int width, std::vector<float>& values);

/// Copies some rows of a cloud to a smaller cloud, and back. `rows` must increase.
GaussianCloud gather_rows(const Exec& exec, const GaussianCloud& cloud, const std::vector<std::int64_t>& rows);
void scatter_rows(const Exec& exec, const GaussianCloud& part, const std::vector<std::int64_t>& rows,
                  GaussianCloud& cloud);

inline std::int64_t source_of(std::int64_t row) { return row; }
inline std::int64_t source_of(const CloudRow& row) { return row.source; }

/// The same for a column of `width` values per Gaussian. Row: a number or a CloudRow.
template <class T, class Row>
std::vector<T> gather_column(const Exec& exec, const std::vector<T>& values, int width, const std::vector<Row>& rows) {
  std::vector<T> part(rows.size() * std::size_t(width));
  for_each_index(exec, std::int64_t(rows.size()), [&](std::int64_t r) {
    std::copy_n(values.begin() + source_of(rows[std::size_t(r)]) * width, width, part.begin() + r * width);
  });
  return part;
}
template <class T>
void scatter_column(const Exec& exec, const std::vector<T>& part, int width, const std::vector<std::int64_t>& rows,
                    std::vector<T>& values) {
  for_each_index(exec, std::int64_t(rows.size()), [&](std::int64_t r) {
    std::copy_n(part.begin() + r * width, width, values.begin() + rows[std::size_t(r)] * width);
  });
}

/// The same for the columns of every object.
std::vector<LabelColumns> gather_labels(const Exec& exec, const std::vector<LabelColumns>& labels,
                                        const std::vector<std::int64_t>& rows);
void scatter_labels(const Exec& exec, const std::vector<LabelColumns>& part, const std::vector<std::int64_t>& rows,
                    std::vector<LabelColumns>& labels);
void edit_labels(const Exec& exec, const std::vector<CloudRow>& rows, std::vector<LabelColumns>& labels);

/// Reorders Adam moments with their Gaussians; new Gaussians get zeros.
void edit_moments(const std::vector<CloudRow>& rows, int width, AdamMoments& moments);

/// The largest of the three scales, world.
double largest_scale(const GaussianCloud& cloud, std::int64_t row);

}  // namespace ngs
