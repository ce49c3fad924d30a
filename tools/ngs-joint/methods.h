#pragma once
// The methods beside the paper's: their options on the command line and the one place that chooses.
#include "joint_run.h"
#include "ngs/methods/method_bce.h"
#include "ngs/methods/method_cob.h"
#include "ngs/methods/method_flash.h"
#include "ngs/methods/method_released.h"
#include "ngs/methods/method_sa3d.h"
#include "ngs/methods/method_saga.h"

namespace ngs::joint {

struct MethodOptions {
  FlashOptions flash;
  Sa3dOptions sa3d;
  BceOptions bce;
  CobOptions cob;
  SagaOptions saga;
  ReleasedOptions released;

  void declare(cli::Tool& tool) {
    tool.options(flash);
    tool.options(sa3d);
    tool.options(bce);
    tool.options(cob);
    tool.options(saga);
    tool.options(released);
  }
};

/// Runs bce and reports loss and certified gap over time, one list per object: the accuracy that time buys.
inline Solution bce_with_trace(cli::Run& run, const BceOptions& options, const Problem& input) {
  BceResult result = solve_bce(run.exec(), run.monitor(), options, input);
  for (const std::vector<GapPoint>& object : result.trace) {
    Json points = Json::array();
    for (const GapPoint& p : object)
      points.push_back({{"t", p.seconds}, {"loss", p.loss}, {"gap", p.gap}, {"certified", p.certified}});
    run.result()["gap_over_time"].push_back(std::move(points));
  }
  return std::move(result.method);
}

/// Not for Method::kPaper.
inline Solution run_beside(cli::Run& run, Method method, const MethodOptions& options,
                               const Problem& input) {
  switch (method) {
    case Method::kFlash:
      return run_flash(run.exec(), run.monitor(), options.flash, input);
    case Method::kSa3d:
      return run_sa3d(run.exec(), run.monitor(), options.sa3d, input);
    case Method::kBce:
      return bce_with_trace(run, options.bce, input);
    case Method::kCob:
      return run_cob(run.exec(), run.monitor(), options.cob, input);
    case Method::kSaga:
      return run_saga(run.exec(), run.monitor(), options.saga, input);
    case Method::kReleased: {
      ReleasedOptions released = options.released;
      released.cob = options.cob;  // it is cob with an extra term
      return run_released(run.exec(), run.monitor(), released, input);
    }
    case Method::kPaper:
      break;
  }
  throw std::logic_error("the joint optimisation is not run here");
}

}  // namespace ngs::joint
