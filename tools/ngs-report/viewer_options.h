#pragma once
// Options of the viewer of ngs-report.
#include "ngs/options/field.h"

namespace ngs::cli {

struct ViewerOptions {
  int gaussians = 300000;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.gaussians, Field<int>{"viewer_gaussians", "",
                                     "Most Gaussians on the 3D page, 44 bytes each; 0: no 3D page", 0, 20000000});
  }
};

}  // namespace ngs::cli
