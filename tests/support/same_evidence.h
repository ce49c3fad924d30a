#pragma once
// Compares evidence bit for bit.
#include "ngs/scene/evidence.h"

namespace ngs::test {

inline bool same_evidence(const Evidence& a, const Evidence& b) {
  if (a.gaussians != b.gaussians || a.objects != b.objects || a.pixels != b.pixels || a.views != b.views ||
      a.weight.whole != b.weight.whole || a.weight.fraction != b.weight.fraction)
    return false;
  const auto share = [](const Evidence& e, std::size_t i, std::size_t k) {
    const ObjectShare* const found = e.share.find(i, k);
    return found == nullptr ? ObjectShare() : *found;
  };
  for (std::size_t i = 0; i < std::size_t(a.gaussians); ++i)
    for (std::size_t k = 0; k < std::size_t(a.objects); ++k)
      if (share(a, i, k) != share(b, i, k)) return false;
  return true;
}

}  // namespace ngs::test
