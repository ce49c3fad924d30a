#include "ngs/ops/field/sample_grid.h"

#include <doctest/doctest.h>

#include <vector>

#include "support/cameras.h"

namespace ngs {
namespace {

/// At the origin, looking along +z, 100 x 80 px, f = 50.
Camera plain_camera() {
  Camera c;
  c.width_px = 100, c.height_px = 80, c.fx = c.fy = 50, c.cx = 50, c.cy = 40;
  c.rotation = {{1, 0, 0, 0, 1, 0, 0, 0, 1}};
  return c;
}

BoundaryBox box_about(std::vector<float> points, double pad_px = 5) {
  return boundary_box(plain_camera(), {points.data(), std::int64_t(points.size() / 3)}, pad_px);
}

}  // namespace

TEST_CASE("the boundary box spans the projected centres plus the padding") {
  const BoundaryBox b = box_about({0, 0, 1, 0.2f, -0.1f, 2});  // at (50, 40) and (55, 37.5)
  CHECK(b.visible == 2);
  CHECK(b.box.min_x == doctest::Approx(45));
  CHECK(b.box.max_x == doctest::Approx(60));
  CHECK(b.box.min_y == doctest::Approx(32.5));
  CHECK(b.box.max_y == doctest::Approx(45));
  CHECK(b.mean_distance == doctest::Approx((1 + std::sqrt(4.05)) / 2));
}

TEST_CASE("a grid of cell centres has rows x cols nodes, none on the border") {
  const PixelGrid g = pixel_grid({10, 20, 30, 60}, 8, 4);
  CHECK(g.cols == 4);
  CHECK(g.rows == 8);
  CHECK(g.x(0) == 12.5);
  CHECK(g.x(3) == 27.5);
  CHECK(g.y(7) == 57.5);
}

TEST_CASE("box_of(grid) recovers the sampled box for any number of nodes") {
  for (const double width : {0.25, 1.0, 3.75, 100.0})
    for (const int cells : {1, 2, 64}) {
      CAPTURE(width);
      CAPTURE(cells);
      const PixelBox box = box_of(pixel_grid({5, 7, 5 + width, 8}, 64, cells));
      CHECK(box.min_x == doctest::Approx(5).epsilon(1e-12));
      CHECK(box.max_x == doctest::Approx(5 + width).epsilon(1e-12));
      CHECK(box.min_y == 7);
      CHECK(box.max_y == 8);
    }
}

TEST_CASE("bilinear weights of an image position sum to one and list every pixel that is read") {
  for (const int size : {1, 2, 7})
    for (double at = -2; at < 9; at += 0.125) {
      double sum = 0, mean = 0;
      for (int pixel = 0; pixel < size; ++pixel) {
        const double w = bilinear_weight(at, size, pixel);
        sum += w, mean += w * pixel;
        CHECK(w >= 0);
      }
      CHECK(sum == 1);
      CHECK(mean == clamp3(at - 0.5, 0.0, size - 1.0));
    }
}

TEST_CASE("the node range of a pixel contains every node that reads the pixel") {
  const PixelGrid grids[] = {pixel_grid({-0.5, 0, 9.7, 5}, 5, 7), pixel_grid({0, 0, 9, 5}, 5, 9),
                             pixel_grid({3.2, 0, 3.9, 5}, 5, 9)};
  for (const PixelGrid& g : grids)
    for (int pixel = 0; pixel < 9; ++pixel) {
      const NodeRange range = nodes_near({g.first_x, g.step_x, g.cols}, 9, pixel, 1.0);
      for (int col = 0; col < g.cols; ++col)
        if (bilinear_weight(g.x(col), 9, pixel) > 0) CHECK((col >= range.first && col <= range.last));
    }
}

}  // namespace ngs
