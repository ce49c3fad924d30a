#include "ngs/edit/fill/fill_texture.h"

#include <doctest/doctest.h>

#include <cmath>
#include <functional>

#include "ngs/core/rng.h"

namespace ngs {
namespace {

using Colour = std::function<double(std::int64_t, std::int64_t)>;

/// A texture of 48 x 40 texels with an unknown square of 13 x 13 in its middle.
TextureGrid with_hole(const Colour& colour) {
  TextureGrid grid{48, 40, {}, {}};
  for (std::int64_t y = 0; y < grid.rows; ++y)
    for (std::int64_t x = 0; x < grid.columns; ++x) {
      const bool unknown = std::abs(x - 24) <= 6 && std::abs(y - 20) <= 6;
      grid.state.push_back(unknown ? Texel::kUnknown : Texel::kKnown);
      for (int c = 0; c < 3; ++c) grid.colour.push_back(unknown ? 77.f : float(colour(x, y)));
    }
  return grid;
}

/// RMS error in the square.
double error_of(const TextureGrid& grid, const Colour& colour) {
  double sum = 0, count = 0;
  for (std::int64_t y = 14; y <= 26; ++y)
    for (std::int64_t x = 18; x <= 30; ++x) {
      const double d = double(grid.colour[std::size_t(3 * (y * grid.columns + x))]) - colour(x, y);
      sum += d * d, ++count;
    }
  return std::sqrt(sum / count);
}

double noise(std::int64_t x, std::int64_t y) { return rng_uniform(1, RngStream::kFill, std::uint64_t(64 * y + x)); }

double stripes(std::int64_t x, std::int64_t y) { return ((x + 2 * y) / 5) % 2 == 0 ? 1 : -1; }

}  // namespace

TEST_CASE("oblique stripes and uneven tiles continue through a hole, far better than the blend of the rim") {
  const Colour tiles = [](std::int64_t x, std::int64_t y) { return double((x / 7 + y / 7) % 2) + 0.2 * noise(x, y); };
  for (const Colour& colour : {Colour(stripes), tiles}) {
    TextureGrid repeats = with_hole(colour), blend = repeats;
    CHECK(fill_texture({}, repeats, 0.07) == TextureFill::kRepeats);
    fill_smoothly(blend);
    CHECK(error_of(repeats, colour) < 0.25 * error_of(blend, colour));
    for (const Texel state : repeats.state) REQUIRE(state == Texel::kKnown);
  }
}

TEST_CASE("a texture that does not repeat is filled with patches, as rich in contrast as itself") {
  TextureGrid grid = with_hole(noise);
  CHECK(fill_texture({}, grid, 0.07) == TextureFill::kPatches);
  CHECK(error_of(grid, [](std::int64_t, std::int64_t) { return 0.5; }) > 0.2);  // 0.29: the deviation of the noise
}

TEST_CASE("a texture without detail is blended, and a gradient continues exactly") {
  const Colour ramp = [](std::int64_t x, std::int64_t y) { return 0.01 * double(x) - 0.02 * double(y); };
  TextureGrid grid = with_hole(ramp);
  CHECK(fill_texture({}, grid, 0.07) == TextureFill::kSmooth);
  CHECK(error_of(grid, ramp) < 1e-3);
}

TEST_CASE("a texture without known or without unknown texels stays as it is") {
  TextureGrid known = with_hole(stripes), unknown = known, none;
  known.state.assign(known.state.size(), Texel::kKnown), unknown.state.assign(unknown.state.size(), Texel::kUnknown);
  CHECK(fill_texture({}, known, 0) == TextureFill::kNothing);
  CHECK(fill_texture({}, unknown, 0) == TextureFill::kNothing);
  CHECK(unknown.state[0] == Texel::kUnknown);
  CHECK(fill_texture({}, none, 0) == TextureFill::kNothing);
}

TEST_CASE("a rim narrower than a patch is blended, and texels that are no part of the texture are not read") {
  TextureGrid grid{6, 6, std::vector<Texel>(36, Texel::kKnown), std::vector<float>(108, 0.5f)};
  grid.state[14] = Texel::kUnknown, grid.state[15] = Texel::kNone;
  for (std::size_t c = 0; c < 3; ++c) grid.colour[45 + c] = NAN, grid.colour[42 + c] = 9;
  for (std::size_t i = 0; i < 36; ++i) grid.colour[3 * i] += float(0.05 * noise(std::int64_t(i), 0));  // some detail
  CHECK(fill_texture({}, grid, 0.001) == TextureFill::kSmooth);
  CHECK(grid.colour[42] == doctest::Approx(0.5).epsilon(0.05));
}

TEST_CASE("repeats and patches have the same bytes for any number of threads") {
  for (const Colour& colour : {Colour(stripes), Colour(noise)}) {
    TextureGrid one = with_hole(colour), three = one;
    Exec exec;
    fill_texture(exec, one, 0.07);
    exec.threads = 3;
    fill_texture(exec, three, 0.07);
    CHECK(one.colour == three.colour);
  }
}

}  // namespace ngs
