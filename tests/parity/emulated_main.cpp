#define DOCTEST_CONFIG_IMPLEMENT_WITH_MAIN
#include "parity/backends.h"

#include "ngs/ops/grid_field_ops.h"
#include "ngs/ops/grid_loss_ops.h"
#include "ngs/ops/grid_splat_ops.h"
#include "ngs/ops/joint_step_grid.h"
#include "support/host_grid.h"

namespace ngs::test {
namespace {

struct Emulated {
  HostGrid grid;
  GridSplatOps<HostGrid> splat{grid};
  GridFieldOps<HostGrid> field{grid};
  GridLossOps<HostGrid> loss{grid};
  GridJointOps<HostGrid> joint{grid};
  DeviceOps ops{splat, field, loss, &joint};
  explicit Emulated(ThreadOrder order) : grid(order) {}
};

}  // namespace

const std::vector<Backend>& backends() {
  static Emulated ascending(ThreadOrder::kAscending), descending(ThreadOrder::kDescending),
      shuffled(ThreadOrder::kShuffled);
  const auto backend = [](const char* name, Emulated& e) {
    return Backend{name, Exec{.device = Device::kCuda, .device_ops = &e.ops}, true, &e.grid.spare_bytes};
  };
  static const std::vector<Backend> all{backend("emulated, ascending", ascending), backend("emulated, descending", descending),
                                        backend("emulated, shuffled", shuffled)};
  return all;
}

}  // namespace ngs::test
