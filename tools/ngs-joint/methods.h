#pragma once
// The methods beside the paper's: their options on the command line and the one place that chooses.
#include "joint_run.h"
#include "ngs/stages/method_bce.h"
#include "ngs/stages/method_cob.h"
#include "ngs/stages/method_flash.h"
#include "ngs/stages/method_released.h"
#include "ngs/stages/method_sa3d.h"
#include "ngs/stages/method_saga.h"

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

/// Not for Method::kPaper.
inline MethodResult run_beside(cli::Run& run, Method method, const MethodOptions& options,
                               const MethodInput& input) {
  switch (method) {
    case Method::kFlash:
      return run_flash(run.exec(), run.monitor(), options.flash, input);
    case Method::kSa3d:
      return run_sa3d(run.exec(), run.monitor(), options.sa3d, input);
    case Method::kBce:
      return run_bce(run.exec(), run.monitor(), options.bce, input);
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
