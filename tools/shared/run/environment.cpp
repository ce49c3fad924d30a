#include "shared/run/environment.h"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <cstring>

#include "ngs/backend/device_info.h"
#include "ngs/core/check.h"
#include "ngs/core/error.h"
#include "shared/os/machine.h"

namespace ngs::cli {
namespace {

constexpr std::string_view kDeviceTools[] = {"ngs cut",   "ngs-mask",   "ngs-variance", "ngs-rbf",
                                             "ngs-joint", "ngs-render", "ngs-fit"};

std::string device_tools() {
  std::string names;
  for (const std::string_view tool : kDeviceTools) names += (names.empty() ? "" : ", ") + std::string(tool);
  return names;
}

}  // namespace

bool has_device_path(std::string_view tool) { return std::ranges::count(kDeviceTools, tool) > 0; }

int choose_threads(int flag) {
  if (flag > 0) return flag;
  for (const char* name : {"NGS_THREADS", "SLURM_CPUS_PER_TASK"}) {
    const char* text = std::getenv(name);
    if (text == nullptr || *text == '\0') continue;
    int threads = 0;
    const char* end = text + std::strlen(text);
    const auto parsed = std::from_chars(text, end, threads);
    if (parsed.ec != std::errc() || parsed.ptr != end || threads < 1 || threads > 4096)
      throw Error(ErrorCode::kUsage, std::string(name) + " = '" + text + "', expected in [1, 4096]",
                  std::string("unset it or use -j"));
    return threads;
  }
  return os::processor_count();
}

const char* isa_name(Isa isa) {
  switch (isa) {
    case Isa::kPortable: return "portable";
    case Isa::kNeon: return "neon";
    case Isa::kV3: return "x86-64-v3";
    default: return "x86-64-v4";
  }
}

Isa choose_isa() {
  const char* text = std::getenv("NGS_ISA");
  if (text == nullptr || *text == '\0') return best_isa();
  const std::string name = text;
  for (const Isa isa : {Isa::kPortable, Isa::kNeon, Isa::kV3, Isa::kV4}) {
    const std::string full = isa_name(isa), brief = full.substr(full.find('v') == 7 ? 7 : 0);
    if (name != full && name != brief) continue;
    if (!can_run(isa))
      throw Error(ErrorCode::kEnvironment, "NGS_ISA = " + name + ": this processor or this build has no " + full,
                  "unset it");
    return isa;
  }
  throw Error(ErrorCode::kUsage, "NGS_ISA = '" + name + "', expected portable, neon, v3 or v4", "unset it");
}

ChosenDevice choose_device(DeviceChoice choice, const Spec& tool) {
  NGS_CHECK(tool.runs_on_device == has_device_path(tool.name), "the list of tools with a device path");
  if (choice == DeviceChoice::kCpu) return {Device::kCpu, "cpu", "--device cpu"};
  const std::string no_path = tool.name + " has no CUDA path";
  if (choice == DeviceChoice::kCuda && !tool.runs_on_device)
    throw Error(ErrorCode::kEnvironment, "--device cuda: " + no_path + ", expected one of " + device_tools(),
                "use --device cpu or auto");
  if (!tool.runs_on_device) return {Device::kCpu, "cpu", "auto: " + no_path};
  const DeviceInfo cuda = cuda_device();
  if (choice == DeviceChoice::kCuda && !cuda.usable)
    throw Error(ErrorCode::kEnvironment, "--device cuda: " + cuda.reason, "use --device cpu or auto");
  if (!cuda.usable) return {Device::kCpu, "cpu", "auto: " + cuda.reason};
  return {Device::kCuda, cuda.name, choice == DeviceChoice::kCuda ? "--device cuda" : "auto", cuda.free_bytes};
}

}  // namespace ngs::cli
