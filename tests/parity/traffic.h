#pragma once
// What the emulated device did, and how large models are there.
#include <doctest/doctest.h>

#include <string>

#include "ngs/scene/gaussian_cloud.h"
#include "parity/emulated.h"

namespace ngs::test {

inline std::size_t geometry_bytes(const GaussianCloud& cloud) {  // with the flag `usable`
  return std::size_t(cloud.size()) * (11 * sizeof(float) + 1);
}

/// What `body` made the device do.
template <class Body>
Traffic traffic_of(Emulated& device, const Body& body) {
  device.launcher.traffic() = {};
  body();
  return device.launcher.traffic();
}

inline void print(const char* what, const Traffic& t) {
  MESSAGE(std::string(what) << ": " << t.launches << " launches, " << t.copies << " copies, " << t.up_bytes
                            << " bytes up, " << t.down_bytes << " down, largest " << t.largest_copy_bytes << ", "
                            << t.allocations << " allocations");
}

}  // namespace ngs::test
