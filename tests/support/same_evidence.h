#pragma once
// Compares evidence bit for bit.
#include "ngs/scene/evidence.h"

namespace ngs::test {

inline ObjectSums sums_of(const Evidence& e, std::size_t gaussian, std::size_t k) {
  const ObjectSums* const found = e.object_weights.find(gaussian, k);
  return found == nullptr ? ObjectSums() : *found;
}

inline std::uint64_t object_pixels(const Evidence& e, std::size_t gaussian, std::size_t k) {
  return sums_of(e, gaussian, k).pixels;
}

inline bool same_evidence(const Evidence& a, const Evidence& b) {
  if (a.gaussians != b.gaussians || a.objects != b.objects || a.pixels != b.pixels || a.views != b.views ||
      a.weight.whole != b.weight.whole || a.weight.fraction != b.weight.fraction)
    return false;
  for (std::size_t i = 0; i < std::size_t(a.gaussians); ++i)
    for (std::size_t k = 0; k < std::size_t(a.objects); ++k)
      if (sums_of(a, i, k) != sums_of(b, i, k) || !a.object_weights.find(i, k) != !b.object_weights.find(i, k))
        return false;
  return true;
}

}  // namespace ngs::test
