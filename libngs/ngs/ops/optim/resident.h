#pragma once
// Arrays that stay in device memory from op to op, for example a trainer's parameters, gradients and moments.
#include <algorithm>
#include <map>
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
    for (const void* array : inputs_) ops_->arrays.drop(array);
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
  /// An array that no op changes; the host's values stay valid.
  template <class T>
  void add_input(const std::vector<T>& values) {
    if (ops_ == nullptr || values.empty()) return;
    ops_->arrays.keep_input(values.data(), values.size() * sizeof(T));
    inputs_.push_back(values.data());
  }
  /// Copies the values of an added array to the host, which has them until an op changes the array.
  template <class T>
  void update_host(std::vector<T>& values) const {
    if (ops_ && !values.empty()) ops_->arrays.update_host(values.data(), values.size() * sizeof(T));
  }
  /// Copies the arrays of add() back to the host.
  void release() {
    for (; !arrays_.empty(); arrays_.pop_back()) ops_->arrays.give_back(arrays_.back());
  }
  /// Whether there is a device that has no arrays yet.
  bool waits() const { return ops_ != nullptr && arrays_.empty(); }

 private:
  const DeviceOps* ops_;
  std::vector<void*> arrays_;  // addresses on the host
  std::vector<const void*> inputs_;
};

/// Images that a loop reads many times. With a device they are cached in its memory, up to a number of bytes; without
/// one none is cached.
class ResidentImages {
 public:
  ResidentImages(const Exec& exec, std::size_t cache_bytes)
      : left_bytes_(exec.device_ops ? cache_bytes : 0), resident_(exec) {}

  /// The cached image; else load(), which is cached if it fits, and is otherwise returned in `scratch`.
  template <class Load>
  const ImageF& get(std::size_t key, ImageF& scratch, const Load& load) {
    if (const auto cached = images_.find(key); cached != images_.end()) return cached->second;
    scratch = load();
    const std::size_t bytes = scratch.data.size() * sizeof(float);
    if (bytes > left_bytes_) return scratch;
    left_bytes_ -= bytes;
    const ImageF& image = images_[key] = std::move(scratch);
    resident_.add_input(image.data);
    return image;
  }

 private:
  std::map<std::size_t, ImageF> images_;
  std::size_t left_bytes_;
  Resident resident_;  // images_
};

/// Sets all values to zero, where they are.
template <class T>
void fill_zero(const Exec& exec, std::vector<T>& values) {
  if (!exec.device_ops || values.empty() || !exec.device_ops->arrays.zero(values.data(), values.size() * sizeof(T)))
    std::fill(values.begin(), values.end(), T(0));
}

/// Arrays and images that ops write and read. With a device their values are only there.
class ResidentResults {
 public:
  explicit ResidentResults(const Exec& exec) : ops_(exec.device_ops) {}
  ~ResidentResults() {
    for (const void* array : arrays_) ops_->arrays.drop(array);
  }
  ResidentResults(const ResidentResults&) = delete;
  ResidentResults& operator=(const ResidentResults&) = delete;

  /// Gives an array its size. Of the right size, it keeps its values; else they are undefined. Only this object changes
  /// the size of the array, which this object must outlive.
  template <class T>
  void shape(std::vector<T>& values, std::size_t size) {
    if (values.size() == size) return;
    drop(values.data());
    values = std::vector<T>(size);
    if (ops_ == nullptr || size == 0) return;
    ops_->arrays.reserve(values.data(), size * sizeof(T));
    arrays_.push_back(values.data());
  }
  /// The same for an image; 0 channels: empty.
  void shape(ImageF& image, int width_px, int height_px, int channels) {
    if (channels == 0) width_px = height_px = 0;
    shape(image.data, std::size_t(width_px) * std::size_t(height_px) * std::size_t(channels));
    image.width_px = width_px;
    image.height_px = height_px;
    image.channels = channels;
  }
  /// An array with these values, on the host too until an op changes them.
  template <class T>
  void assign(std::vector<T>& values, std::vector<T>&& from) {
    if (ops_ == nullptr) {
      values = std::move(from);
      return;
    }
    shape(values, from.size());
    std::copy(from.begin(), from.end(), values.begin());
    if (!values.empty()) ops_->arrays.update_device(values.data(), values.size() * sizeof(T));
  }

 private:
  void drop(const void* array) {
    const auto at = std::find(arrays_.begin(), arrays_.end(), array);
    if (at == arrays_.end()) return;
    ops_->arrays.drop(array);
    arrays_.erase(at);
  }
  const DeviceOps* ops_;
  std::vector<const void*> arrays_;  // addresses on the host
};

}  // namespace ngs
