#pragma once
// Options of the fill of the hole that a removed object leaves in the background.
#include "ngs/options/field.h"

namespace ngs {

enum class FillKind : std::uint8_t { kOff, kAuto, kPlane, kSurface };
inline constexpr NamedValue<FillKind> kFillNames[] = {
    {FillKind::kOff, "off"}, {FillKind::kAuto, "auto"}, {FillKind::kPlane, "plane"}, {FillKind::kSurface, "surface"}};

struct FillOptions {
  FillKind fill = FillKind::kAuto;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.fill, Choice<FillKind>{"fill",
                                      "How to fill the hole in the background: on planes at its rim, on a "
                                      "curved surface, or auto: on planes if they explain the rim",
                                      kFillNames});
  }
};

}  // namespace ngs
