#include "ngs/render/render_options.h"

#include <doctest/doctest.h>

namespace ngs {

TEST_CASE("splat options come from the options, else from the scene, else from the PLY") {
  Scene scene;
  GaussianCloud cloud;
  cloud.antialiased = true;
  CHECK(splat_options({}, cloud, scene).compat == Compat::kInria);
  CHECK(splat_options({}, cloud, scene).antialiased);
  scene.compat = Compat::kGsplat, scene.antialiased = false;
  CHECK(splat_options({}, cloud, scene).compat == Compat::kGsplat);
  CHECK_FALSE(splat_options({}, cloud, scene).antialiased);
  CHECK(splat_options({.compat = CompatChoice::kInria}, cloud, scene).compat == Compat::kInria);
  CHECK(splat_options({.antialias = Antialias::kOn}, cloud, scene).antialiased);
  scene.compat = Compat::kInria;
  CHECK(splat_options({.compat = CompatChoice::kGsplat}, cloud, scene).compat == Compat::kGsplat);
}

}  // namespace ngs
