#pragma once
// Host arrays whose current values are in device memory. Kernels' arguments are looked up here by their host address
// (DeviceBuffer), so that ops need not know where an array lives.
#include <cstddef>
#include <map>

#include "ngs/core/check.h"

namespace ngs {

class ResidentTable {
 public:
  struct Array {
    std::size_t bytes;
    char* device;
  };

  void insert(const void* host, const Array& array) {
    NGS_CHECK(find(host, array.bytes) == nullptr, "an array is resident once");
    arrays_[static_cast<const char*>(host)] = array;
  }
  /// The array that begins at `host` is no longer resident.
  Array erase(const void* host) {
    const auto found = arrays_.find(static_cast<const char*>(host));
    NGS_CHECK(found != arrays_.end(), "a resident array");
    const Array array = found->second;
    arrays_.erase(found);
    return array;
  }
  /// The device address of host[0, bytes); null: not resident. All of it is resident, or nothing.
  void* find(const void* host, std::size_t bytes) const {
    const char* const begin = static_cast<const char*>(host);
    if (bytes == 0 || begin == nullptr) return nullptr;
    const auto next = arrays_.lower_bound(begin + bytes);
    if (next == arrays_.begin()) return nullptr;
    const auto& [at, array] = *std::prev(next);
    if (at + array.bytes <= begin) return nullptr;
    NGS_CHECK(at <= begin && begin + bytes <= at + array.bytes, "all of an argument is resident, or nothing");
    return array.device + (begin - at);
  }

 private:
  std::map<const char*, Array> arrays_;  // by host address
};

}  // namespace ngs
