#include <doctest/doctest.h>

#include "ngs/scene/resize.h"

namespace ngs {
namespace {

ImageF picture(int width_px, int height_px, double (*value)(double, double)) {
  ImageF image(width_px, height_px, 2);
  for (int y = 0; y < height_px; ++y)
    for (int x = 0; x < width_px; ++x) {
      image.at(x, y, 0) = float(value(x + 0.5, y + 0.5));
      image.at(x, y, 1) = 7;
    }
  return image;
}

}  // namespace

TEST_CASE("enlarged: the same size gives the same image") {
  const ImageF image = picture(5, 4, [](double x, double y) { return x * x - 3 * y; });
  CHECK(enlarged(image, 5, 4).data == image.data);
}

TEST_CASE("enlarged: a linear ramp is reproduced away from the border, and channels do not mix") {
  const ImageF fine = enlarged(picture(8, 6, [](double x, double y) { return 2 * x - y; }), 16, 12);
  for (int y = 4; y < 8; ++y)
    for (int x = 4; x < 12; ++x) {
      CHECK(fine.at(x, y, 0) == doctest::Approx(2 * (x + 0.5) / 2 - (y + 0.5) / 2));
      CHECK(fine.at(x, y, 1) == doctest::Approx(7));
    }
}

TEST_CASE("enlarged: a dark line one pixel wide stays dark at any ratio") {
  const ImageF line = picture(9, 1, [](double x, double) { return x == 4.5 ? 0.0 : 1.0; });
  const ImageF thrice = enlarged(line, 27, 3), odd = enlarged(line, 13, 2);
  CHECK(thrice.at(13, 1, 0) == doctest::Approx(0));
  CHECK(thrice.at(10, 1, 0) > 0.9);
  CHECK(odd.at(6, 0, 0) < 0.1);
}

}  // namespace ngs
