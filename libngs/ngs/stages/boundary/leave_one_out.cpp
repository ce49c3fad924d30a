#include "ngs/stages/boundary/leave_one_out.h"

#include <algorithm>

namespace ngs {
namespace {

constexpr double kLeastRest = 1e-3;  // fraction of a Gaussian's weight that must remain without a view

}  // namespace

LeaveOneOut::LeaveOneOut(const Exec& exec, std::int64_t gaussians, int objects, Gather gather, std::size_t cache_bytes)
    : exec_(exec),
      gaussians_(gaussians),
      objects_(std::size_t(objects)),
      gather_(std::move(gather)),
      left_bytes_(cache_bytes),
      object_weight_(std::size_t(gaussians), objects_) {
  weight_.resize(std::size_t(gaussians));
}

void LeaveOneOut::start(const std::vector<LabelColumns>& labels, const std::vector<float>& weight,
                        const std::vector<std::size_t>& views) {
  for (std::size_t i = 0; i < weight.size(); ++i) weight_.add(i, double(weight[i]));
  for (std::size_t k = 0; k < objects_; ++k)
    for (std::size_t i = 0; i < weight.size(); ++i)
      if (const double prob = double(labels[k].prob[i]); prob > 0)
        object_weight_.touch(i, k).add(prob * double(weight[i]));
  not_kept_.insert(views.begin(), views.end());
}

std::shared_ptr<const ViewWeights> LeaveOneOut::weights_of(std::size_t n) {
  if (const auto kept = cache_.find(n); kept != cache_.end()) return kept->second;
  if (!not_kept_.contains(n)) return nullptr;
  auto own = std::make_shared<const ViewWeights>(gather_(n));
  keep(n, own);
  return own;
}

void LeaveOneOut::keep(std::size_t n, const std::shared_ptr<const ViewWeights>& own) {
  if (own->bytes() > left_bytes_) {
    not_kept_.insert(n);
    return;
  }
  left_bytes_ -= own->bytes();
  cache_[n] = own, not_kept_.erase(n);
}

void LeaveOneOut::add(std::size_t n) {
  const auto own = std::make_shared<const ViewWeights>(gather_(n));
  std::vector<std::vector<SparseTable<ExactSum>::Insert>> deferred_inserts(own->parts());
  for_each_task(exec_, std::int64_t(own->parts()), [&](std::int64_t part) {
    own->for_each(std::size_t(part), [&](std::uint32_t gaussian, const double* mine) {
      weight_.add(gaussian, mine[0]);
      for (std::size_t k = 0; k < objects_; ++k)
        if (mine[1 + k] != 0)
          object_weight_.add(gaussian, k, ExactSum::of(mine[1 + k]), deferred_inserts[std::size_t(part)]);
    });
  });
  for (const auto& of : deferred_inserts) object_weight_.add(of);
  keep(n, own);
}

void LeaveOneOut::remove(std::size_t n) {
  const std::shared_ptr<const ViewWeights> own = weights_of(n);
  if (!own) return;
  for_each_in(*own, [&](std::size_t i, const double* mine, float*) {
    weight_.subtract(i, mine[0]);
    for (std::size_t k = 0; k < objects_; ++k)
      if (ExactSum* const known = mine[1 + k] != 0 ? object_weight_.find(i, k) : nullptr)
        known->subtract(ExactSum::of(mine[1 + k]));
  });
  if (not_kept_.erase(n) == 0) left_bytes_ += own->bytes(), cache_.erase(n);
}

LeaveOneOut::Shares LeaveOneOut::shares_of(std::size_t gaussian, float* share) const {
  const double all = weight_.value(gaussian);
  std::fill_n(share, objects_, 0.f);
  if (all > 0)
    object_weight_.for_each_in(gaussian,
                               [&](std::size_t k, const ExactSum& weight) { share[k] = float(weight.value() / all); });
  return {all > 0, share};
}

LeaveOneOut::Shares LeaveOneOut::shares_without(std::size_t gaussian, const double* mine, float* share) const {
  const double all = weight_.value(gaussian), others = all - mine[0];
  const bool seen = others > kLeastRest * all;
  std::fill_n(share, objects_, 0.f);
  if (seen)
    object_weight_.for_each_in(gaussian, [&](std::size_t k, const ExactSum& weight) {
      share[k] = float(std::max(0.0, weight.value() - mine[1 + k]) / others);
    });
  return {seen, share};
}

}  // namespace ngs
