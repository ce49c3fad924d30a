#include "ngs/core/parse_number.h"

#include <doctest/doctest.h>

#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <sstream>
#include <string>

#include "ngs/core/rng.h"

using namespace ngs;

namespace {

/// Checks that both parsers of T agree on a text: value, end and error.
template <class T>
void check_same(const std::string& text) {
  CAPTURE(text);
  T expected = T(7), found = T(7);
  const char *const begin = text.data(), *const end = begin + text.size();
  const std::from_chars_result by_library = std::from_chars(begin, end, expected);
  const std::from_chars_result by_c = scan_by_strtod(begin, end, found);
  CHECK(by_c.ptr - begin == by_library.ptr - begin);
  CHECK(by_c.ec == by_library.ec);
  CHECK(
      (std::isnan(expected) ? std::isnan(found) : found == expected && std::signbit(found) == std::signbit(expected)));
}

}  // namespace

#ifdef __cpp_lib_to_chars
TEST_CASE("scan_by_strtod returns the value, end and error of std::from_chars") {
  std::istringstream texts(
      "|-|+1| 1|1 |-0|0|1|-1.5|.5|5.|.|-.|1e3|1e|1e+|1e-3x|e5|0x10|-0X1p3|0x|inf|-inf|INFINITY|infinit|nan"
      "|-nan|NaN|n|in|1,5|1_000|1e400|-1e400|1e39|1e-400|-1e-400|1e-46|1e-45|4.9e-324|2e-324|0e999|0.0e-999"
      "|3.4028236e38|1.7976931348623157e308|1.7976931348623159e308|0.1000000000000000055511151231257827"
      "|123456789012345678901234567890|- 1|-+1|--1");
  for (std::string text; std::getline(texts, text, '|');) {
    check_same<float>(text);
    check_same<double>(text);
  }
}

TEST_CASE("scan_by_strtod equals std::from_chars for random numbers in every notation") {
  for (std::uint64_t n = 0; n < 2000; ++n) {
    const double value = std::bit_cast<double>(rng_bits(31, RngStream::kTest, n));
    char text[64];
    for (const char* form : {"%.17g", "%.6g", "%.3f", "%a"}) {
      if (std::abs(value) > 1e30 && std::string(form) == "%.3f") continue;
      std::snprintf(text, sizeof text, form, value);
      check_same<float>(text);
      check_same<double>(text);
    }
  }
}
#endif

TEST_CASE("parse_number accepts a text only if all of it is a number in range") {
  int whole = 0;
  double real = 0;
  CHECK((parse_number("-12", whole) && whole == -12));
  CHECK((parse_number("2.5e-1", real) && real == 0.25));
  for (const char* text : {"", "12 ", " 12", "12a", "+12", "0x1", "99999999999"}) CHECK(!parse_number(text, whole));
  for (const char* text : {"", "1.5m", " 1", "+1", "0x1", "1e999"}) CHECK(!parse_number(text, real));
}
