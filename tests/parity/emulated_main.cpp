#define DOCTEST_CONFIG_IMPLEMENT_WITH_MAIN
#include <memory>

#include "parity/backends.h"
#include "parity/emulated.h"

namespace ngs::test {
namespace {

/// The emulation in three thread orders. Its objects live as long as the process.
std::vector<Backend> emulated(DeviceSums sums, const std::string& what) {
  static std::vector<std::unique_ptr<Emulated>> all;
  std::vector<Backend> backends;
  const auto add = [&](const char* name, ThreadOrder order) {
    Emulated& e = *all.emplace_back(std::make_unique<Emulated>(order, sums));
    backends.push_back({"emulated, " + std::string(name) + what, e.exec(), true, sums == DeviceSums::kInOrder});
  };
  add("ascending", ThreadOrder::kAscending);
  add("descending", ThreadOrder::kDescending);
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
