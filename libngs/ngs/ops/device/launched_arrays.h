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

  void run(const ScatterRows& host, std::int64_t rows) const override {
    ScatterRows kernel = host;
    for (int c = 0; c < ScatterRows::kColumns; ++c)
      kernel.part[c] = at(host.part[c], host.width[c]), kernel.all[c] = at(host.all[c], host.width[c]);
    kernel.row = at(host.row, rows);
    launcher_.parallel_for(rows, kernel);
  }
  void run(const GatherRows& host, std::int64_t rows) const override {
    const DeviceBuffer<Launcher, float> part =
        DeviceBuffer<Launcher, float>::result(launcher_, host.part, rows * host.width);
    launcher_.parallel_for(rows, GatherRows{at(host.row, rows), host.width, at(host.all, rows), part.data()});
    part.to(host.part);
  }
  void run(const RowColours& host, std::int64_t rows) const override {
    launcher_.parallel_for(rows, RowColours{at(host.row, rows), at(host.sh_dc, rows), at(host.colour, rows)});
  }
  void run(const ClearShapes& host, std::int64_t rows) const override {
    launcher_.parallel_for(rows, ClearShapes{at(host.chosen, rows), at(host.position, rows), at(host.rotation, rows),
                                             at(host.log_scale, rows), at(host.logit_opacity, rows)});
  }
  void run(const AddProjectedGradients& host, std::int64_t rows) const override {
    AddProjectedGradients kernel = host;
    kernel.visible = at(host.visible, rows), kernel.mean_px = at(host.mean_px, rows);
    kernel.sum = at(host.sum, rows), kernel.views = at(host.views, rows);
    launcher_.parallel_for(rows, kernel);
  }
  void run(const FadeNear& host, std::int64_t rows) const override {
    FadeNear kernel = host;
    kernel.visible = at(host.visible, rows), kernel.position = at(host.position, rows);
    kernel.logit_opacity = at(host.logit_opacity, rows);
    launcher_.parallel_for(rows, kernel);
  }
  void run(const AddValues& host, std::int64_t rows) const override {
    launcher_.parallel_for(rows, AddValues{at(host.from, rows), at(host.to, rows)});
  }
  void run(const LabelCellGradients& host, std::int64_t rows) const override {
    if (host.cells.count == 0) return;
    launcher_.parallel_for(rows, LabelCellGradients{at(host.cells), at(host.grad_label, rows), at(host.grad, rows)});
  }
  void run(const LabelCellValues& host, std::int64_t rows) const override {
    if (host.cells.count == 0) return;
    launcher_.parallel_for(rows,
                           LabelCellValues{at(host.cells), at(host.row, host.row ? rows : 0), at(host.label, rows)});
  }

 private:
  void* insert(const void* host, std::size_t bytes) const {
    void* const device = launcher_.allocate(bytes);
    launcher_.resident.insert(host, {bytes, static_cast<char*>(device)});
    return device;
  }
  /// The device address of a resident array; null if it has no values.
  template <class T>
  T* at(T* host, std::int64_t values) const {
    if (values == 0) return nullptr;
    void* const device = launcher_.resident.find(host, sizeof(T));
    NGS_CHECK(device != nullptr, "the arrays of a row kernel are resident");
    return static_cast<T*>(device);
  }
  LabelCells at(const LabelCells& host) const {
    const auto count = std::int64_t(host.count);
    return {at(host.begin, 1), at(host.object, count), at(host.logit, count), host.objects, host.count};
  }

  Launcher& launcher_;
};

}  // namespace ngs
