#include "ngs/stages/boundary/leave_one_out.h"

#include <algorithm>

#include "ngs/backend/for_each.h"

namespace ngs {
namespace {

constexpr double kLeastRest = 1e-3;  // of a Gaussian's weight
constexpr std::int64_t kRowsPerTask = 4096;

}  // namespace

LeaveOneOut::LeaveOneOut(const Exec& exec, std::int64_t gaussians, int objects, Gather gather, std::size_t kept_bytes)
    : exec_(exec),
      gaussians_(gaussians),
      objects_(std::size_t(objects)),
      gather_(std::move(gather)),
      left_bytes_(kept_bytes) {
  weight_.resize(std::size_t(gaussians)), object_weight_.resize(std::size_t(gaussians) * objects_);
}

LeaveOneOut::Own LeaveOneOut::own_of(const ViewSums& one) const {
  Own own{one.row, std::vector<double>(one.size() * (1 + objects_))};
  for_each_index(exec_, std::int64_t(one.size()), [&](std::int64_t row) {
    const auto v = std::size_t(row);
    double* weight = &own.weight[v * (1 + objects_)];
    weight[0] = one.weight(v);
    for (std::size_t k = 0; k < objects_; ++k) weight[1 + k] = one.object_weight(v, k);
  });
  return own;
}

std::size_t LeaveOneOut::bytes_of(const Own& own) {
  return own.row.size() * sizeof(own.row[0]) + own.weight.size() * sizeof(own.weight[0]);
}

bool LeaveOneOut::is_not_kept(std::size_t n) const {
  return std::find(not_kept_.begin(), not_kept_.end(), n) != not_kept_.end();
}

void LeaveOneOut::add(std::size_t n) {
  Own own = own_of(gather_(n));
  for_each_index(exec_, std::int64_t(own.row.size()), [&](std::int64_t v) {
    const double* weight = &own.weight[std::size_t(v) * (1 + objects_)];
    const std::size_t i = own.row[std::size_t(v)];
    weight_.add(i, weight[0]);
    for (std::size_t k = 0; k < objects_; ++k) object_weight_.add(i * objects_ + k, weight[1 + k]);
  });
  const std::size_t bytes = bytes_of(own);
  if (bytes > left_bytes_) return not_kept_.push_back(n);
  left_bytes_ -= bytes;
  kept_[n] = std::move(own);
}

void LeaveOneOut::remove(std::size_t n) {
  const auto kept = kept_.find(n);
  if (kept == kept_.end() && !is_not_kept(n)) return;
  const Own own = kept == kept_.end() ? own_of(gather_(n)) : std::move(kept->second);
  for_each_index(exec_, std::int64_t(own.row.size()), [&](std::int64_t v) {
    const double* weight = &own.weight[std::size_t(v) * (1 + objects_)];
    const std::size_t i = own.row[std::size_t(v)];
    weight_.subtract(i, weight[0]);
    for (std::size_t k = 0; k < objects_; ++k) object_weight_.subtract(i * objects_ + k, weight[1 + k]);
  });
  if (kept == kept_.end()) {
    std::erase(not_kept_, n);
  } else {
    left_bytes_ += bytes_of(own);
    kept_.erase(kept);
  }
}

LeaveOneOut::Rest LeaveOneOut::without(std::size_t n) const {
  const auto rows = std::size_t(gaussians_);
  Own again;
  const auto kept = kept_.find(n);
  if (kept == kept_.end() && is_not_kept(n)) again = own_of(gather_(n));
  const Own& own = kept == kept_.end() ? again : kept->second;
  Rest rest{std::vector<std::uint8_t>(rows), std::vector<float>(rows * objects_), std::vector<double>(rows)};
  const std::vector<double> none(1 + objects_, 0.0);
  for_each_task(exec_, (gaussians_ + kRowsPerTask - 1) / kRowsPerTask, [&](std::int64_t task) {
    const auto begin = std::size_t(task * kRowsPerTask), end = std::min(rows, begin + std::size_t(kRowsPerTask));
    auto v = std::size_t(std::lower_bound(own.row.begin(), own.row.end(), begin) - own.row.begin());
    for (std::size_t i = begin; i < end; ++i) {
      const bool here = v < own.row.size() && own.row[v] == i;
      const double* mine = here ? &own.weight[v++ * (1 + objects_)] : none.data();
      rest.own[i] = mine[0];
      const double all = weight_.value(i), weight = all - mine[0];
      if (!(weight > kLeastRest * all)) continue;
      rest.seen[i] = 1;
      for (std::size_t k = 0; k < objects_; ++k)
        rest.share[i * objects_ + k] = float((object_weight_.value(i * objects_ + k) - mine[1 + k]) / weight);
    }
  });
  return rest;
}

}  // namespace ngs
