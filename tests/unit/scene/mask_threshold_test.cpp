#include "ngs/scene/mask_threshold.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

namespace ngs {

TEST_CASE("exactly one half is foreground in a given mask, background in a label, and set in a flag") {
  const float below = std::nextafter(0.5f, 0.f), above = std::nextafter(0.5f, 1.f);
  CHECK(mask_is_foreground(0.5f));
  CHECK_FALSE(mask_is_foreground(below));
  CHECK_FALSE(label_is_foreground(0.5f));
  CHECK(label_is_foreground(above));
  CHECK(is_set(0.5f));
  CHECK_FALSE(is_set(below));
}

TEST_CASE("NaN is background in masks and labels, and not set in flags") {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  CHECK_FALSE(mask_is_foreground(nan));
  CHECK_FALSE(label_is_foreground(nan));
  CHECK_FALSE(is_set(nan));
}

}  // namespace ngs
