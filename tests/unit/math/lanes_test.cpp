#include "ngs/math/lanes.h"

#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <vector>

#include "ngs/math/lanes_portable.h"
#include "support/random.h"

namespace ngs {
namespace {

std::uint32_t bits_of(float x) { return __builtin_bit_cast(std::uint32_t, x); }
/// The bits of x; all NaNs are equal, because processors differ in which NaN they return.
std::uint32_t value_of(float x) { return std::isnan(x) ? 0x7fc00000u : bits_of(x); }

/// Random bits, or a value next to a limit of the format, a whole number or a tie of half precision.
float awkward_float(test::Random& random) {
  static constexpr float kBorders[] = {0.f,     1.f,     0x1p-126f, 0x1p-149f, 0x1p23f,  0x1p24f,    0x1p31f,
                                       65504.f, 65520.f, 0x1p-14f,  0x1p-24f,  0x1p-25f, 0x1.002p0f, 0.5f,
                                       1.5f,    2.5f,    0x1p127f,  INFINITY,  NAN};
  const auto pick = std::uint32_t(random.uniform(0, 4));
  std::uint32_t bits = std::uint32_t(random.uniform(0, 0x1p32));
  if (pick == 1) bits = bits_of(float(random.uniform(-40, 40)));
  if (pick >= 2) {
    bits = bits_of(kBorders[std::size_t(random.uniform(0, double(std::size(kBorders))))]);
    bits += std::uint32_t(int(random.uniform(0, 5)) - 2);
    if (random.uniform(0, 1) < 0.5) bits ^= 0x80000000u;
  }
  return __builtin_bit_cast(float, bits);
}

/// The bits of all operations of a lane type on 8 values a, b, c.
template <class L, class Half>
std::vector<std::uint32_t> all_operations(const float* a, const float* b, const float* c) {
  std::vector<std::uint32_t> bits;
  const auto record = [&](L x) {
    float lane[8];
    store_lanes(lane, x);
    for (const float value : lane) bits.push_back(value_of(value));
  };
  L x, y, z, first;
  load_lanes(a, x);
  load_lanes(b, y);
  load_lanes(c, z);
  iota_lanes(a[0], first);
  for (const L result : {x + y, x - y, x * y, x / y, -x, fma_lanes(x, y, z), sqrt_lanes(x), floor_lanes(x),
                         Half(x).wide(), first, folded(x), L(c[0])})
    record(result);
  record(min_lanes(x, y));
  record(max_lanes(x, y));
  record(x += z);
  for (const auto mask : {x<y, x <= y, x> y, x >= y, !(x < y), (x < y) | (y < z), (x < y) & (y < z),
                          and_at_least(x < z, x, y), all_lanes(x)}) {
    record(select(mask, x, y));
    bits.push_back(any(mask));
    bits.push_back(std::uint32_t(count_lanes(mask)));
  }
  return bits;
}

}  // namespace

TEST_CASE("exp2_where stays within 0.8 ulp of exp2 over [-126, 0]") {
  double worst = 0;
  for (int i = 0; i <= 2000000; ++i) {
    const float x = -126.f * float(i) / 2000000.f;
    const double want = std::exp2(double(x));
    const double ulp = double(std::nextafter(float(want), 2.f)) - double(float(want));
    worst = std::max(worst, std::abs(double(exp2_where(true, x)) - want) / ulp);
  }
  MESSAGE("worst error in ulp: ", worst);
  CHECK(worst < 0.8);
}

TEST_CASE_TEMPLATE("exp2_where of a pack equals the scalar in every lane", L, PackF, PortablePack) {
  for (int i = 0; i < 100000; ++i) {
    float in[8], out[8];
    for (int k = 0; k < 8; ++k) in[k] = -float(i * 8 + k) * 1.2e-4f;
    L x;
    load_lanes(in, x);
    const float bound = in[i % 8];
    store_lanes(out, exp2_where(x <= L(bound), x));
    for (int k = 0; k < 8; ++k) REQUIRE(out[k] == exp2_where(in[k] <= bound, in[k]));
  }
}

TEST_CASE("packs of every instruction set give the same bits for all inputs") {
  test::Random random(11);
  for (int i = 0; i < 40000; ++i) {
    float in[3][8];
    for (auto& pack : in)
      for (float& value : pack) value = awkward_float(random);
    REQUIRE(all_operations<PackF, HalfPack>(in[0], in[1], in[2]) ==
            all_operations<PortablePack, HalfPair<PortableQuad>>(in[0], in[1], in[2]));
  }
}

TEST_CASE_TEMPLATE("every lane of a pack computes the same bits as a float", L, PackF, PortablePack) {
  test::Random random(12);
  for (int i = 0; i < 20000; ++i) {
    float a[8], b[8], c[8], sum[8], fused[8], root[8], down[8];
    for (int k = 0; k < 8; ++k) {
      a[k] = awkward_float(random);
      b[k] = awkward_float(random);
      c[k] = awkward_float(random);
    }
    L x, y, z;
    load_lanes(a, x);
    load_lanes(b, y);
    load_lanes(c, z);
    store_lanes(sum, x + y);
    store_lanes(fused, fma_lanes(x, y, z));
    store_lanes(root, sqrt_lanes(x));
    store_lanes(down, floor_lanes(x));
    for (int k = 0; k < 8; ++k) {
      REQUIRE(value_of(sum[k]) == value_of(a[k] + b[k]));
      REQUIRE(value_of(fused[k]) == value_of(std::fma(a[k], b[k], c[k])));
      REQUIRE(value_of(root[k]) == value_of(std::sqrt(a[k])));
      REQUIRE(value_of(down[k]) == value_of(std::floor(a[k])));
    }
  }
}

TEST_CASE("fma_by_double is rounded once, even where a sum in double would be rounded twice") {
  test::Random random(13);
  int twice = 0;
  for (int i = 0; i < 400000; ++i) {
    // c is about half a step of a b: the sum lies close to the middle between two floats.
    const float a = awkward_float(random), b = i % 2 == 0 ? awkward_float(random) : 1.f + 0x1p-23f * float(i % 1000);
    const float c = i % 3 == 0 ? awkward_float(random) : std::ldexp(a * b, -24 - i % 30);
    const QuadF out = fma_by_double(QuadF{a, c, b, a}, QuadF{b, b, a, a}, QuadF{c, a, -c, c});
    REQUIRE(value_of(out[0]) == value_of(std::fma(a, b, c)));
    REQUIRE(value_of(out[1]) == value_of(std::fma(c, b, a)));
    REQUIRE(value_of(out[2]) == value_of(std::fma(b, a, -c)));
    REQUIRE(value_of(out[3]) == value_of(std::fma(a, a, c)));
    twice += value_of(float(double(a) * double(b) + double(c))) != value_of(out[0]);
  }
  CHECK(twice > 0);  // the inputs include such cases
  // Among subnormal floats: the sum is below the middle between c and the next one, by less than doubles tell.
  const float a = 0x1p-75f * (1 + 0x1p-23f), b = 0x1p-75f * (1 - 0x1p-23f), c = 0x1p-127f + 0x1p-149f;
  CHECK(value_of(float(double(a) * double(b) + double(c))) != value_of(c));
  CHECK(value_of(fma_by_double(QuadF{a}, QuadF{b}, QuadF{c})[0]) == value_of(c));
}

TEST_CASE("portable half precision round-trips every half and rounds floats to nearest, ties to even") {
  for (std::uint32_t half = 0; half < 0x10000u; ++half) {
    const float wide = float_of_half(std::uint16_t(half));
    if ((half & 0x7fffu) <= 0x7c00u) REQUIRE(half_bits(wide) == half);
    if ((half & 0x7fffu) > 0x7c00u) REQUIRE(std::isnan(wide));
    if ((half & 0x7fffu) >= 0x7c00u) continue;
    const float next = float_of_half(std::uint16_t(half + 1));
    if (!std::isfinite(next)) continue;
    const float middle = 0.5f * (wide + next);
    CHECK(half_bits(middle) == (half % 2 == 0 ? half : half + 1));
    CHECK(half_bits(std::nextafter(middle, wide)) == half);
    CHECK(half_bits(std::nextafter(middle, next)) == half + 1);
  }
  CHECK(float_of_half(0x3c00) == 1.f);
  CHECK(float_of_half(0x0001) == 0x1p-24f);
  CHECK(half_bits(65519.f) == 0x7bff);
  CHECK(half_bits(-65520.f) == 0xfc00);
}

TEST_CASE("sum_lanes and store_row_bits give the same bits in every pack") {
  test::Random random(14);
  for (int i = 0; i < 2000; ++i) {
    std::vector<float> value(7 * 8);
    for (float& x : value) x = float(random.uniform(-1, 1)) * std::ldexp(1.f, int(random.uniform(-20, 20)));
    PackF native[7];
    PortablePack portable[7];
    float sums[2][7], want[7];
    for (int k = 0; k < 7; ++k) {
      const float* v = value.data() + 8 * k;
      load_lanes(v, native[k]);
      load_lanes(v, portable[k]);
      want[k] = ((v[0] + v[4]) + (v[2] + v[6])) + ((v[1] + v[5]) + (v[3] + v[7]));
      CHECK(sum_lanes(native[k]) == want[k]);
      CHECK(sum_lanes(portable[k]) == want[k]);
      for (int lane = 0; lane < 4; ++lane) {
        CHECK(low_half(portable[k]).lane(lane) == double(v[lane]));
        CHECK(high_half(native[k]).lane(lane) == double(v[4 + lane]));
        CHECK(high_half(portable[k]).lane(lane) == double(v[4 + lane]));
      }
    }
    sum_lanes_each(native, 7, sums[0]);
    sum_lanes_each(portable, 7, sums[1]);
    CHECK(std::memcmp(sums[0], want, sizeof want) == 0);
    CHECK(std::memcmp(sums[1], want, sizeof want) == 0);

    float begin[8], end[8];
    std::uint32_t rows[3][8];
    for (int k = 0; k < 8; ++k) {
      begin[k] = float(int(random.uniform(0, 32)));
      end[k] = float(int(random.uniform(0, 32)));
      store_row_bits(&rows[2][k], begin[k], end[k]);
    }
    load_lanes(begin, native[0]);
    load_lanes(end, native[1]);
    store_row_bits(rows[0], native[0], native[1]);
    load_lanes(begin, portable[0]);
    load_lanes(end, portable[1]);
    store_row_bits(rows[1], portable[0], portable[1]);
    CHECK(std::memcmp(rows[0], rows[2], sizeof rows[0]) == 0);
    CHECK(std::memcmp(rows[1], rows[2], sizeof rows[0]) == 0);
  }
}

}  // namespace ngs
