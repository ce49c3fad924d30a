#include "ngs/stages/boundary/leave_one_out.h"

#include <algorithm>

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

std::shared_ptr<const ViewWeights> LeaveOneOut::weights_of(std::size_t n) const {
  if (const auto kept = kept_.find(n); kept != kept_.end()) return kept->second;
  return not_kept_.contains(n) ? std::make_shared<const ViewWeights>(gather_(n)) : nullptr;
}

void LeaveOneOut::add(std::size_t n) {
  const auto own = std::make_shared<const ViewWeights>(gather_(n));
  for_each_in(*own, [&](std::size_t i, const double* mine, float*) {
    weight_.add(i, mine[0]);
    for (std::size_t k = 0; k < objects_; ++k)
      if (mine[1 + k] != 0) object_weight_.add(i * objects_ + k, mine[1 + k]);
  });
  if (own->bytes() > left_bytes_) {
    not_kept_.insert(n);
    return;
  }
  left_bytes_ -= own->bytes();
  kept_[n] = own;
}

void LeaveOneOut::remove(std::size_t n) {
  const std::shared_ptr<const ViewWeights> own = weights_of(n);
  if (!own) return;
  for_each_in(*own, [&](std::size_t i, const double* mine, float*) {
    weight_.subtract(i, mine[0]);
    for (std::size_t k = 0; k < objects_; ++k)
      if (mine[1 + k] != 0) object_weight_.subtract(i * objects_ + k, mine[1 + k]);
  });
  if (not_kept_.erase(n) == 0) left_bytes_ += own->bytes(), kept_.erase(n);
}

void LeaveOneOut::add_elsewhere(const std::vector<double>& weight) {
  for_each_index(exec_, gaussians_, [&](std::int64_t i) {
    if (weight[std::size_t(i)] > 0) weight_.add(std::size_t(i), weight[std::size_t(i)]);
  });
}

LeaveOneOut::Shares LeaveOneOut::shares_of(std::size_t gaussian, float* share) const {
  const double all = weight_.value(gaussian);
  for (std::size_t k = 0; k < objects_; ++k) share[k] = all > 0 ? float(object_weight(gaussian, k) / all) : 0.f;
  return {all > 0, share};
}

LeaveOneOut::Shares LeaveOneOut::shares_without(std::size_t gaussian, const double* mine, float* share) const {
  const double all = weight_.value(gaussian), others = all - mine[0];
  const bool seen = others > kLeastRest * all;
  for (std::size_t k = 0; k < objects_; ++k)
    share[k] = seen ? float((object_weight(gaussian, k) - mine[1 + k]) / others) : 0.f;
  return {seen, share};
}

}  // namespace ngs
