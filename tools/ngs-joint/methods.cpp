#include "methods.h"

#include <stdexcept>

#include "ngs/options/name_of.h"

namespace ngs::joint {
namespace {

/// Runs bce and reports its loss and certified gap over time, one list per object.
Solution bce_with_trace(cli::Run& run, const BceOptions& options, const Problem& problem) {
  BceResult result = solve_bce(run.exec(), run.monitor(), options, problem);
  for (const std::vector<GapPoint>& object : result.trace) {
    Json points = Json::array();
    for (const GapPoint& p : object)
      points.push_back({{"t", p.seconds}, {"loss", p.loss}, {"gap", p.gap}, {"certified", p.certified}});
    run.result()["gap_over_time"].push_back(std::move(points));
  }
  return std::move(result.method);
}

}  // namespace

std::string method_name(Method method) { return name_of(kMethodNames, method); }

void BaselineOptions::declare(cli::Tool& tool, const Method& method) {
  const auto group = [&](Method one, std::string_view cites) {
    const std::string name = method_name(one);
    return OptionGroup{
        .name = name,
        .about = std::string(cites),
        .applies = [&method, one] { return method == one || (one == Method::kCob && method == Method::kReleased); },
        .needs = "--method " + name};
  };
  tool.options(flash, group(Method::kFlash, "FlashSplat, closed form"));
  tool.options(sa3d, group(Method::kSa3d, "SA3D-GS, closed form"));
  tool.options(bce, group(Method::kBce, "optimal labels of unchanged Gaussians"));
  tool.options(cob, group(Method::kCob, "COB-GS"));
  tool.options(saga, group(Method::kSaga, "SAGA features from masks"));
  tool.options(released, group(Method::kReleased, "the published NG-GS code"));
}

Solution run_baseline(cli::Run& run, Method method, const BaselineOptions& options, const Problem& problem) {
  switch (method) {
    case Method::kFlash: return run_flash(run.exec(), run.monitor(), options.flash, problem);
    case Method::kSa3d: return run_sa3d(run.exec(), run.monitor(), options.sa3d, problem);
    case Method::kBce: return bce_with_trace(run, options.bce, problem);
    case Method::kCob: return run_cob(run.exec(), run.monitor(), options.cob, problem);
    case Method::kSaga: return run_saga(run.exec(), run.monitor(), options.saga, problem);
    case Method::kReleased: {
      ReleasedOptions released = options.released;
      released.cob = options.cob;  // the method is cob with an extra loss term
      return run_released(run.exec(), run.monitor(), released, problem);
    }
    case Method::kNgs:
    case Method::kNgGs: break;
  }
  throw std::logic_error("ngs and ng-gs are no baselines");
}

}  // namespace ngs::joint
