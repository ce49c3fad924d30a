#pragma once
// Options of every tool that renders a model.
#include "ngs/ops/splat/splat.h"
#include "ngs/options/field.h"
#include "ngs/scene/scene.h"

namespace ngs {

enum class Antialias : std::uint8_t { kAuto, kOn, kOff };
enum class CompatChoice : std::uint8_t { kAuto, kInria, kGsplat };
inline constexpr NamedValue<Compat> kCompatNames[] = {{Compat::kInria, "inria"}, {Compat::kGsplat, "gsplat"}};
inline constexpr NamedValue<CompatChoice> kCompatChoices[] = {
    {CompatChoice::kAuto, "auto"}, {CompatChoice::kInria, "inria"}, {CompatChoice::kGsplat, "gsplat"}};
inline constexpr NamedValue<Antialias> kAntialiasNames[] = {
    {Antialias::kAuto, "auto"}, {Antialias::kOn, "on"}, {Antialias::kOff, "off"}};

struct RasterOptions {
  CompatChoice compat = CompatChoice::kAuto;
  Antialias antialias = Antialias::kAuto;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.compat, Choice<CompatChoice>{"compat", "Near plane and footprint rule to use; auto: from scene.json",
                                            kCompatChoices});
    visit(self.antialias,
          Choice<Antialias>{"antialias", "Opacity compensation; auto: from scene.json, else from the PLY",
                            kAntialiasNames});
  }
};

/// Options for renders of the scene's views at its working size.
inline SplatOptions splat_options(const RasterOptions& options, const GaussianCloud& cloud, const Scene& scene) {
  const bool antialiased = options.antialias == Antialias::kAuto ? scene.antialiased.value_or(cloud.antialiased)
                                                                 : options.antialias == Antialias::kOn;
  const Compat compat = options.compat == CompatChoice::kAuto    ? scene.compat
                        : options.compat == CompatChoice::kInria ? Compat::kInria
                                                                 : Compat::kGsplat;
  return {compat, antialiased, 3, scene.filter_px2, scene.world_unit};
}

}  // namespace ngs
