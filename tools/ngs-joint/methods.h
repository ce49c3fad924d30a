#pragma once
// The methods of ngs-joint, and the options of the baselines.

#include "ngs/cut/methods/method_bce.h"
#include "ngs/cut/methods/method_cob.h"
#include "ngs/cut/methods/method_flash.h"
#include "ngs/cut/methods/method_released.h"
#include "ngs/cut/methods/method_sa3d.h"
#include "ngs/cut/methods/method_saga.h"
#include "shared/tool.h"

namespace ngs::joint {

/// kNgs: all passes, the NeRF only if there are no photos. kNgGs: the joint stage of the paper with its NeRF and none
/// of our passes.
enum class Method : std::uint8_t { kNgs, kNgGs, kBce, kCob, kFlash, kSa3d, kSaga, kReleased };
inline constexpr NamedValue<Method> kMethodNames[] = {
    {Method::kNgs, "ngs"},     {Method::kNgGs, "ng-gs"}, {Method::kBce, "bce"},   {Method::kCob, "cob"},
    {Method::kFlash, "flash"}, {Method::kSa3d, "sa3d"},  {Method::kSaga, "saga"}, {Method::kReleased, "released"}};
std::string method_name(Method method);
/// Whether the method renders views; flash is computed from the evidence alone.
constexpr bool renders_views(Method method) { return method != Method::kFlash; }

struct BaselineOptions {
  FlashOptions flash;
  Sa3dOptions sa3d;
  BceOptions bce;
  CobOptions cob;
  SagaOptions saga;
  ReleasedOptions released;

  /// Declares one group per method, which applies if `method` is selected; `method` must outlive the tool.
  void declare(cli::Tool& tool, const Method& method);
};

/// `method` must not be kNgs or kNgGs.
Solution run_baseline(cli::Run& run, Method method, const BaselineOptions& options, const Problem& problem);

}  // namespace ngs::joint
