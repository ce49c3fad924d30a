#include "ngs/stages/boundary/leave_one_out.h"

#include <algorithm>

#include "ngs/backend/for_each.h"

namespace ngs {
namespace {

constexpr double kLeastRest = 1e-3;  // of a Gaussian's weight

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

void LeaveOneOut::add_elsewhere(const std::vector<double>& weight) {
  for_each_index(exec_, gaussians_, [&](std::int64_t i) {
    if (weight[std::size_t(i)] > 0) weight_.add(std::size_t(i), weight[std::size_t(i)]);
  });
}

LeaveOneOut::Shares LeaveOneOut::all() const {
  const auto rows = std::size_t(gaussians_);
  Shares shares{std::vector<std::uint8_t>(rows), std::vector<float>(rows * objects_)};
  for_each_index(exec_, gaussians_, [&](std::int64_t row) {
    const auto i = std::size_t(row);
    const double weight = weight_.value(i);
    if (!(weight > 0)) return;
    shares.seen[i] = 1;
    for (std::size_t k = 0; k < objects_; ++k) shares.share[i * objects_ + k] = float(object_weight(i, k) / weight);
  });
  return shares;
}

LeaveOneOut::Rest LeaveOneOut::without(std::size_t n) const {
  const auto kept = kept_.find(n);
  if (kept == kept_.end() && !is_not_kept(n)) return {};
  Own again;
  if (kept == kept_.end()) again = own_of(gather_(n));
  const Own& own = kept == kept_.end() ? again : kept->second;
  const std::size_t rows = own.row.size();
  Rest rest{own.row, {std::vector<std::uint8_t>(rows), std::vector<float>(rows * objects_)}, std::vector<double>(rows)};
  for_each_index(exec_, std::int64_t(rows), [&](std::int64_t row) {
    const auto v = std::size_t(row);
    const std::size_t i = own.row[v];
    const double* mine = &own.weight[v * (1 + objects_)];
    rest.own[v] = mine[0];
    const double all = weight_.value(i), weight = all - mine[0];
    if (!(weight > kLeastRest * all)) return;
    rest.others.seen[v] = 1;
    for (std::size_t k = 0; k < objects_; ++k)
      rest.others.share[v * objects_ + k] = float((object_weight(i, k) - mine[1 + k]) / weight);
  });
  return rest;
}

}  // namespace ngs
