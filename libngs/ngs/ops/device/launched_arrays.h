#pragma once
// DeviceArrays on a Launcher.
#include <cstring>

#include "ngs/backend/launcher.h"
#include "ngs/core/check.h"
#include "ngs/ops/device/device_ops.h"

namespace ngs {

template <class Launcher>
class LaunchedArrays final : public DeviceArrays {
 public:
  explicit LaunchedArrays(Launcher& launcher) : launcher_(launcher) {}

  void keep(void* host, std::size_t bytes) const override {
    keep_input(host, bytes);
    if (Launcher::kSpoilsHost) std::memset(host, 0xff, bytes);
  }
  void keep_input(const void* host, std::size_t bytes) const override {
    launcher_.upload(insert(host, bytes), host, bytes);
  }
  void reserve(void* host, std::size_t bytes) const override {
    insert(host, bytes);
    if (Launcher::kSpoilsHost) std::memset(host, 0xff, bytes);
  }
  bool zero(void* host, std::size_t bytes) const override {
    void* const device = launcher_.resident.find(host, bytes);
    if (device != nullptr) launcher_.fill_zero(device, bytes);
    return device != nullptr;
  }
  void update_host(void* host, std::size_t bytes) const override {
    launcher_.download(host, launcher_.resident.find(host, bytes), bytes);
  }
  void update_device(const void* host, std::size_t bytes) const override {
    launcher_.upload(launcher_.resident.find(host, bytes), host, bytes);
  }
  void give_back(void* host) const override {
    const ResidentTable::Array array = launcher_.resident.erase(host);
    launcher_.download(host, array.device, array.bytes);
    launcher_.release(array.device);
  }
  void drop(const void* host) const noexcept override { launcher_.release(launcher_.resident.erase(host).device); }

  void run(const RowKernel& on_host, std::int64_t rows) const override {
    if (rows == 0) return;
    std::visit(
        [&](auto kernel) {
          kernel.each_array([&](auto*& array) { array = on_device(array); });
          launcher_.parallel_for(rows, kernel);
        },
        on_host);
  }

 private:
  void* insert(const void* host, std::size_t bytes) const {
    void* const device = launcher_.allocate(bytes);
    launcher_.resident.insert(host, {bytes, static_cast<char*>(device)});
    return device;
  }
  template <class T>
  T* on_device(T* host) const {
    void* const device = launcher_.resident.find(host, sizeof(T));
    NGS_CHECK(device != nullptr, "the arrays of a row kernel are resident");
    return static_cast<T*>(device);
  }

  Launcher& launcher_;
};

}  // namespace ngs
