#define DOCTEST_CONFIG_IMPLEMENT_WITH_MAIN
#include <memory>

#include "ngs/ops/device/launched_field_ops.h"
#include "ngs/ops/device/launched_loss_ops.h"
#include "ngs/ops/device/launched_splat_ops.h"
#include "parity/backends.h"
#include "support/host_launcher.h"

namespace ngs::test {
namespace {

struct Emulated {
  HostLauncher launcher;
  LaunchedSplatOps<HostLauncher> splat;
  LaunchedFieldOps<HostLauncher> field;
  LaunchedLossOps<HostLauncher> loss{launcher};
  DeviceOps ops{splat, field, loss};
  Emulated(ThreadOrder order, DeviceSums sums) : launcher(order), splat(launcher, sums), field(launcher, sums) {}
};

/// The emulation in three thread orders. Its objects live as long as the process.
std::vector<Backend> emulated(DeviceSums sums, const std::string& what) {
  static std::vector<std::unique_ptr<Emulated>> all;
  std::vector<Backend> backends;
  const auto add = [&](const char* name, ThreadOrder order) {
    Emulated& e = *all.emplace_back(std::make_unique<Emulated>(order, sums));
    backends.push_back(
        {"emulated, " + std::string(name) + what, Exec{.device = Device::kCuda, .device_ops = &e.ops}, true});
  };
  add("ascending", ThreadOrder::kAscending), add("descending", ThreadOrder::kDescending);
  add("shuffled", ThreadOrder::kShuffled);
  return backends;
}

}  // namespace

const std::vector<Backend>& backends() {
  static const std::vector<Backend> all = emulated(DeviceSums::kInOrder, "");
  return all;
}
const std::vector<Backend>& atomic_backends() {
  static const std::vector<Backend> all = emulated(DeviceSums::kAtomic, ", atomic sums");
  return all;
}

}  // namespace ngs::test
