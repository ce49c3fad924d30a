#pragma once
// A Monitor for a call whose reports a test does not read.
#include "ngs/core/monitor.h"

namespace ngs::test {

/// Passed as a Monitor&; it ends with the full expression, so nothing may keep it.
class Quiet {
 public:
  operator Monitor&() { return monitor_; }

 private:
  Monitor monitor_;
};

}  // namespace ngs::test
