#include "ngs/stages/leave_one_out.h"

#include <algorithm>

namespace ngs {
namespace {

constexpr double kLeastRest = 1e-3;  // of a Gaussian's weight

}  // namespace

LeaveOneOut::LeaveOneOut(std::int64_t gaussians, int objects, Gather gather, std::size_t kept_bytes)
    : gather_(std::move(gather)), kept_bytes_(kept_bytes), all_(gaussians, objects) {}

LeaveOneOut::Own LeaveOneOut::own_of(const Evidence& one) {
  const auto rows = std::size_t(one.gaussians), cells = rows * std::size_t(one.objects);
  Own own{std::vector<double>(rows), std::vector<double>(cells)};
  for (std::size_t i = 0; i < rows; ++i) own.weight[i] = one.weight.value(i);
  for (std::size_t i = 0; i < cells; ++i) own.object_weight[i] = one.object_weight.value(i);
  return own;
}

void LeaveOneOut::add(std::size_t n) {
  Evidence one(all_.gaussians, all_.objects);
  gather_(n, one);
  all_.add(one);
  const std::size_t bytes = std::size_t(one.gaussians) * std::size_t(1 + one.objects) * sizeof(double);
  if ((kept_.size() + 1) * bytes <= kept_bytes_)
    kept_[n] = own_of(one);
  else
    not_kept_.push_back(n);
}

LeaveOneOut::Rest LeaveOneOut::without(std::size_t n) const {
  const auto rows = std::size_t(all_.gaussians), objects = std::size_t(all_.objects);
  Own again;
  const auto kept = kept_.find(n);
  const Own* own = kept == kept_.end() ? nullptr : &kept->second;
  if (own == nullptr && std::find(not_kept_.begin(), not_kept_.end(), n) != not_kept_.end()) {
    Evidence one(all_.gaussians, all_.objects);
    gather_(n, one);
    again = own_of(one), own = &again;
  }
  Rest rest{std::vector<std::uint8_t>(rows), std::vector<float>(rows * objects)};
  for (std::size_t i = 0; i < rows; ++i) {
    const double all = all_.weight.value(i), weight = all - (own ? own->weight[i] : 0);
    if (!(weight > kLeastRest * all)) continue;
    rest.seen[i] = 1;
    for (std::size_t k = i * objects; k < (i + 1) * objects; ++k)
      rest.share[k] = float((all_.object_weight.value(k) - (own ? own->object_weight[k] : 0)) / weight);
  }
  return rest;
}

}  // namespace ngs
