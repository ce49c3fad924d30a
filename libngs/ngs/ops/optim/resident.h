#pragma once
// Arrays that stay in device memory from op to op, for example a trainer's parameters, gradients and moments.
#include <vector>

#include "ngs/backend/exec.h"
#include "ngs/ops/device/device_ops.h"

namespace ngs {

/// With a device: from add() to release(), ops read and write the device's copy of these arrays, and the host's values
/// are undefined. The arrays must stay in place and outlive this object. On the CPU nothing happens.
class Resident {
 public:
  explicit Resident(const Exec& exec) : ops_(exec.device_ops) {}
  /// Forgets the arrays without copying them back.
  ~Resident() {
    for (void* array : arrays_) ops_->arrays.drop(array);
  }
  Resident(const Resident&) = delete;
  Resident& operator=(const Resident&) = delete;

  template <class T>
  void add(std::vector<T>& values) {
    if (ops_ == nullptr || values.empty()) return;
    ops_->arrays.keep(values.data(), values.size() * sizeof(T));
    arrays_.push_back(values.data());
  }
  /// Copies all arrays back to the host.
  void release() {
    for (; !arrays_.empty(); arrays_.pop_back()) ops_->arrays.give_back(arrays_.back());
  }
  /// Whether there is a device that has no arrays yet.
  bool waits() const { return ops_ != nullptr && arrays_.empty(); }

 private:
  const DeviceOps* ops_;
  std::vector<void*> arrays_;  // addresses on the host
};

}  // namespace ngs
