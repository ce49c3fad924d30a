#include "ngs/cut/evidence/leave_one_out.h"

namespace ngs {

LeaveOneOut::LeaveOneOut(const Exec& exec, std::int64_t gaussians, int objects, Gather gather, std::size_t cache_bytes)
    : exec_(exec), gather_(std::move(gather)), left_bytes_(cache_bytes), sums_(gaussians, objects) {}

void LeaveOneOut::start(const std::vector<LabelColumns>& labels, const std::vector<float>& weight,
                        const std::vector<std::size_t>& views) {
  for (std::size_t i = 0; i < weight.size(); ++i) sums_.weight.add(i, double(weight[i]));
  for (std::size_t k = 0; k < labels.size(); ++k)
    for (std::size_t i = 0; i < weight.size(); ++i)
      if (const double prob = double(labels[k].prob[i]); prob > 0) sums_.add_object(i, k, prob * double(weight[i]));
  uncached_.insert(views.begin(), views.end());
}

std::shared_ptr<const PackedSums> LeaveOneOut::weights_of(std::size_t n) {
  if (const auto kept = cache_.find(n); kept != cache_.end()) return kept->second;
  if (!uncached_.contains(n)) return nullptr;
  auto own = std::make_shared<const PackedSums>(gather_(n));
  keep(n, own);
  return own;
}

void LeaveOneOut::keep(std::size_t n, const std::shared_ptr<const PackedSums>& own) {
  if (own->bytes() > left_bytes_) {
    uncached_.insert(n);
    return;
  }
  left_bytes_ -= own->bytes();
  cache_[n] = own;
  uncached_.erase(n);
}

void LeaveOneOut::add(std::size_t n) {
  const auto own = std::make_shared<const PackedSums>(gather_(n));
  std::vector<WeightSums<>::DeferredInserts> deferred_inserts(own->parts());
  for_each_task(exec_, std::int64_t(own->parts()), [&](std::int64_t part) {
    own->for_each(std::size_t(part), [&](std::uint32_t gaussian, const double* mine) {
      sums_.weight.add(gaussian, mine[0]);
      for (std::size_t k = 0; k < std::size_t(sums_.objects); ++k)
        if (mine[1 + k] != 0)
          sums_.object_weights.add(gaussian, k, {ExactSum::of(mine[1 + k])}, deferred_inserts[std::size_t(part)]);
    });
  });
  for (const auto& of : deferred_inserts) sums_.object_weights.add(of);
  keep(n, own);
}

void LeaveOneOut::remove(std::size_t n) {
  const std::shared_ptr<const PackedSums> own = weights_of(n);
  if (!own) return;
  for_each_in(*own, [&](std::size_t i, const double* mine, float*) {
    sums_.weight.subtract(i, mine[0]);
    for (std::size_t k = 0; k < std::size_t(sums_.objects); ++k) sums_.remove_object(i, k, mine[1 + k]);
  });
  if (uncached_.erase(n) == 0) {
    left_bytes_ += own->bytes();
    cache_.erase(n);
  }
}

}  // namespace ngs
