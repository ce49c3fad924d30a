#pragma once
// What the viewer of ngs-report holds.
#include "ngs/options/field.h"

namespace ngs::cli {

struct ViewerOptions {
  int gaussians = 300000;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.gaussians,
          Field<int>{"viewer_gaussians", "",
                     "of the object that --viewer holds at most, those that show most; 44 bytes each", 1, 20000000});
  }
};

}  // namespace ngs::cli
