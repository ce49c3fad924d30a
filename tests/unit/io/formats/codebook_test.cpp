#include "ngs/io/formats/compression/codebook.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "support/random.h"

namespace ngs {
namespace {

double squared_error(const io::Codebook& codebook, const std::vector<float>& values) {
  double sum = 0;
  for (const float v : values) sum += std::pow(double(v) - double(codebook[io::nearest_in(codebook, v)]), 2);
  return sum;
}

TEST_CASE("up to 256 distinct values are kept exactly") {
  std::vector<float> values;
  for (int i = 0; i < 1000; ++i) values.push_back(float((i * 37) % 256) * 0.5f - 3.f);
  const io::Codebook codebook = io::fit_codebook(values);
  CHECK(std::is_sorted(codebook.begin(), codebook.end()));
  CHECK(squared_error(codebook, values) == 0);
  CHECK(io::fit_codebook({})[7] == 0);
  const float one = 5;
  CHECK(io::fit_codebook({&one, 1})[255] == 5.f);
}

TEST_CASE("a codebook has less error than 256 even steps, with and without an outlier") {
  for (const bool far : {false, true}) {
    CAPTURE(far);
    test::Random random(3);
    std::vector<float> values;
    for (int i = 0; i < 20000; ++i) values.push_back(float(std::pow(random.uniform(-1, 1), 3)));
    if (far) values.push_back(30.f);
    const io::Codebook codebook = io::fit_codebook(values);
    CHECK(std::is_sorted(codebook.begin(), codebook.end()));
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    io::Codebook even;
    for (std::size_t k = 0; k < even.size(); ++k) even[k] = *low + (*high - *low) * float(k) / 255.f;
    CHECK(squared_error(codebook, values) < squared_error(even, values) * (far ? 0.01 : 1));
    // Panter and Dite: (integral of the cube root of the density)³ / 12 K² a value; the density is |v|^(-2/3) / 6.
    if (!far) CHECK(squared_error(codebook, values) < 20000 * 8 / 6.0 * std::pow(9 / 7.0, 3) / 12 / (256 * 256));
  }
}

TEST_CASE("the nearest value of a codebook is found, also with equal values") {
  io::Codebook codebook;
  codebook.fill(4.f);
  codebook[0] = -1, codebook[1] = 0, codebook[2] = 0, codebook[3] = 1;
  CHECK(io::nearest_in(codebook, -9.f) == 0);
  CHECK(io::nearest_in(codebook, 0.f) == 1);
  CHECK(io::nearest_in(codebook, 0.4f) == 1);
  CHECK(io::nearest_in(codebook, 0.5f) == 1);
  CHECK(io::nearest_in(codebook, 0.6f) == 3);
  CHECK(io::nearest_in(codebook, 3.f) == 4);
  CHECK(io::nearest_in(codebook, 9.f) == 4);
}

TEST_CASE("a palette keeps few distinct rows exactly, and many as cluster means") {
  const std::vector<float> few = {1, 2, 3, 4, 1, 2, 5, 6};
  const io::Palette kept = io::fit_palette(few, 2, 3);
  REQUIRE(kept.rows.size() == 6);
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t c = 0; c < 2; ++c) CHECK(kept.rows[kept.label[i] * 2 + c] == few[i * 2 + c]);

  test::Random random(5);
  std::vector<float> many;  // four clusters far apart
  for (int i = 0; i < 400; ++i)
    for (int c = 0; c < 3; ++c) many.push_back(float((i % 4 == c ? 10 : 0) + random.uniform(-0.1, 0.1)));
  const io::Palette palette = io::fit_palette(many, 3, 4);
  REQUIRE(palette.rows.size() == 12);
  for (std::size_t i = 0; i < 400; ++i) {
    CHECK(palette.label[i] == palette.label[i % 4]);
    for (std::size_t c = 0; c < 3; ++c)
      CHECK(std::abs(palette.rows[palette.label[i] * 3 + c] - many[i * 3 + c]) < 0.21);
  }
}

TEST_CASE("rows whose mean rounds to one of them are still split") {
  const float a = 1, b = std::nextafter(1.f, 2.f);
  const io::Palette palette = io::fit_palette(std::vector<float>{b, a, b, b}, 1, 4);
  CHECK(palette.rows[palette.label[1]] == a);
  CHECK(palette.rows[palette.label[0]] == b);
}

}  // namespace
}  // namespace ngs
