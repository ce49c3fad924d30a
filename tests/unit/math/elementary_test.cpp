#include "ngs/math/elementary.h"

#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>

#include "support/random.h"

namespace ngs {
namespace {

/// A hash of the bits of several results (FNV-1a by values).
class BitSum {
 public:
  void add(std::uint64_t bits) { sum_ = (sum_ ^ bits) * 1099511628211u; }
  void add(float x) { add(std::uint64_t(__builtin_bit_cast(std::uint32_t, x))); }
  void add(double x) { add(__builtin_bit_cast(std::uint64_t, x)); }
  std::uint64_t value() const { return sum_; }

 private:
  std::uint64_t sum_ = 14695981039346656037u;
};

double ulps(float got, double want) {
  const float at = float(std::abs(want));
  return std::abs(double(got) - want) / (double(std::nextafter(at, INFINITY)) - double(at));
}

/// Every 4099th float in [from, to], in the order of bits; both ends have the same sign.
template <class F>
void for_floats(float from, float to, F&& f) {
  const auto last = __builtin_bit_cast(std::uint32_t, to);
  for (std::uint64_t bits = __builtin_bit_cast(std::uint32_t, from); bits <= last; bits += 4099)
    f(__builtin_bit_cast(float, std::uint32_t(bits)));
}

}  // namespace

TEST_CASE("log1p and expm1 of a float are accurate to one unit in the last place") {
  double worst_log = 0, worst_exp = 0;
  const auto look = [&](float x) {
    if (x > -1.f) worst_log = std::max(worst_log, ulps(portable_log1p(x), std::log1p(double(x))));
    if (x < 88.f) worst_exp = std::max(worst_exp, ulps(portable_expm1(x), std::expm1(double(x))));
  };
  for_floats(0x1p-126f, 0x1p127f, look);
  for_floats(-0x1p-126f, -100.f, look);
  MESSAGE("worst in ulp: log1p ", worst_log, ", expm1 ", worst_exp);
  CHECK(worst_log < 1);
  CHECK(worst_exp < 1);
}

TEST_CASE("exp and log of a float are accurate to 0.51 and 0.82 units in the last place") {
  double worst_log = 0, worst_exp = 0;
  const auto look = [&](float x) {
    if (x > 0.f) worst_log = std::max(worst_log, ulps(portable_log(x), std::log(double(x))));
    if (x < 88.f && x > -87.f) worst_exp = std::max(worst_exp, ulps(portable_exp(x), std::exp(double(x))));
  };
  for_floats(0x1p-149f, 0x1p127f, look);
  for_floats(-0x1p-126f, -100.f, look);
  MESSAGE("worst in ulp: log ", worst_log, ", exp ", worst_exp);
  CHECK(worst_log < 0.82);
  CHECK(worst_exp < 0.51);
}

TEST_CASE("exp and log of a float have the right limits and special values") {
  CHECK(portable_exp(0.f) == 1.f);
  CHECK(portable_exp(-0.f) == 1.f);
  CHECK(portable_exp(-INFINITY) == 0.f);
  CHECK(portable_exp(-0x1.9fe368p6f) == 0x1p-149f);  // the smallest argument whose result is not 0
  CHECK(portable_exp(std::nextafter(-0x1.9fe368p6f, -INFINITY)) == 0.f);
  CHECK(portable_exp(0x1.62e42ep6f) == 0x1.ffff08p127f);
  CHECK(portable_exp(std::nextafter(0x1.62e42ep6f, INFINITY)) == INFINITY);
  CHECK(std::isnan(portable_exp(NAN)));
  CHECK(portable_log(0.f) == -INFINITY);
  CHECK(portable_log(-0.f) == -INFINITY);
  CHECK(portable_log(1.f) == 0.f);
  CHECK(portable_log(INFINITY) == INFINITY);
  CHECK(std::isnan(portable_log(-1.f)));
  CHECK(std::isnan(portable_log(-INFINITY)));
  CHECK(std::isnan(portable_log(NAN)));
}

TEST_CASE("log1p and expm1 of a float have the right limits and special values") {
  CHECK(portable_log1p(-1.f) == -INFINITY);
  CHECK(std::isnan(portable_log1p(-1.5f)));
  CHECK(std::isnan(portable_log1p(NAN)));
  CHECK(portable_log1p(INFINITY) == INFINITY);
  CHECK(std::signbit(portable_log1p(-0.f)));
  CHECK(portable_expm1(-INFINITY) == -1.f);
  CHECK(portable_expm1(-200.f) == -1.f);
  CHECK(portable_expm1(88.8f) == INFINITY);
  CHECK(std::isnan(portable_expm1(NAN)));
  CHECK(std::signbit(portable_expm1(-0.f)));
}

TEST_CASE("hypot neither overflows nor underflows, and is accurate to one unit in the last place") {
  CHECK(portable_hypot(3, -4) == 5);
  CHECK(portable_hypot(3e300, 4e300) == doctest::Approx(5e300).epsilon(1e-15));
  CHECK(portable_hypot(3e-310, 4e-310) == doctest::Approx(5e-310).epsilon(1e-12));
  CHECK(portable_hypot(-INFINITY, NAN) == INFINITY);
  CHECK(std::isnan(portable_hypot(1, NAN)));
  CHECK(portable_hypot(0, 0) == 0);
  CHECK(portable_hypot(1, 1e-20) == 1);
  test::Random random(21);
  for (int i = 0; i < 20000; ++i) {
    const double x = random.uniform(-1, 1), y = random.uniform(-1, 1);
    CHECK(std::abs(portable_hypot(x, y) - std::hypot(x, y)) <= 0x1p-52 * std::hypot(x, y));
  }
}

// Reference hashes from glibc 2.36 on x86-64, whose expf, logf, log1pf and expm1f give the same bits for every float.
// Another processor, compiler or C library must not change them: models and masks would differ.
TEST_CASE("exp, log, log1p, expm1 and hypot have the same bits on every machine") {
  BitSum log1p_bits, expm1_bits, log_bits, exp_bits, hypot_bits;
  const auto add = [&](float x) {
    if (x > -1.f) log1p_bits.add(portable_log1p(x));
    expm1_bits.add(portable_expm1(x));
    exp_bits.add(portable_exp(x));
    if (x > 0.f) log_bits.add(portable_log(x));
  };
  for_floats(0x1p-126f, 0x1p127f, add);
  for_floats(-0x1p-126f, -100.f, add);
  test::Random random(22);
  for (int i = 0; i < 100000; ++i) {
    const double x = random.uniform(-1, 1), y = random.uniform(-4, 4);
    hypot_bits.add(portable_hypot(x, y));
  }
  CHECK(log1p_bits.value() == 0x95ea3ee6af6add6u);
  CHECK(expm1_bits.value() == 0x6dcdfc784e889e18u);
  CHECK(exp_bits.value() == 0x6b3fda4a2ff301ffu);
  CHECK(log_bits.value() == 0x6cc61027a5a8a951u);
  CHECK(hypot_bits.value() == 0xea49bed185b56c6cu);
}

}  // namespace ngs
