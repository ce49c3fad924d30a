#pragma once
// The methods of ngs-joint, and the options of those that are baselines.
#include <functional>

#include "ngs/methods/method_bce.h"
#include "ngs/methods/method_cob.h"
#include "ngs/methods/method_flash.h"
#include "ngs/methods/method_released.h"
#include "ngs/methods/method_sa3d.h"
#include "ngs/methods/method_saga.h"
#include "shared/tool.h"

namespace ngs::joint {

/// kNgs: our passes, and the NeRF where it gains. kNgGs: the joint stage of the paper with its NeRF and nothing of
/// ours.
enum class Method : std::uint8_t { kNgs, kNgGs, kBce, kCob, kFlash, kSa3d, kSaga, kReleased };
inline constexpr NamedValue<Method> kMethodNames[] = {
    {Method::kNgs, "ngs"},     {Method::kNgGs, "ng-gs"}, {Method::kBce, "bce"},   {Method::kCob, "cob"},
    {Method::kFlash, "flash"}, {Method::kSa3d, "sa3d"},  {Method::kSaga, "saga"}, {Method::kReleased, "released"}};
std::string method_name(Method method);
/// Whether it looks at views; flash follows from the evidence.
constexpr bool draws(Method method) { return method != Method::kFlash; }

struct BaselineOptions {
  FlashOptions flash;
  Sa3dOptions sa3d;
  BceOptions bce;
  CobOptions cob;
  SagaOptions saga;
  ReleasedOptions released;

  /// A group each, which `method` listens to or not; it must outlive the tool.
  void declare(cli::Tool& tool, const Method& method);
};

/// Not for kNgs and kNgGs.
Solution run_baseline(cli::Run& run, Method method, const BaselineOptions& options, const Problem& problem);

}  // namespace ngs::joint
