#include "ngs/core/parse_number.h"

#include <cmath>
#include <string>

#include "ngs/os/plain_number.h"

namespace ngs {
namespace {

float convert(const char* text, char** stop, float) { return os::plain_strtof(text, stop); }
double convert(const char* text, char** stop, double) { return os::plain_strtod(text, stop); }

bool begins_number(std::string_view text) {
  if (text.starts_with('-')) text.remove_prefix(1);
  constexpr std::string_view kFirst = ".0123456789iInN";
  return !text.empty() && kFirst.find(text.front()) != std::string_view::npos;
}

/// The text without what strtod would read as a hexadecimal number: of "0x1f" only the 0 is a number.
std::string decimal_part(std::string_view text) {
  const std::size_t digits = text.starts_with('-') ? 1 : 0;
  const std::string_view prefix = text.substr(digits, 2);
  return std::string(prefix == "0x" || prefix == "0X" ? text.substr(0, digits + 1) : text);
}

/// True if a digit before the exponent is not 0.
bool is_not_zero(std::string_view text) {
  return text.substr(0, text.find_first_of("eE")).find_first_of("123456789") != std::string_view::npos;
}

template <class T>
std::from_chars_result scan(const char* begin, const char* end, T& value) {
  const std::string_view given(begin, std::size_t(end - begin));
  if (!begins_number(given)) return {begin, std::errc::invalid_argument};
  const std::string text = decimal_part(given);
  char* stop = nullptr;
  const T number = convert(text.c_str(), &stop, T{});
  if (stop == text.c_str()) return {begin, std::errc::invalid_argument};
  const std::string_view read(text.c_str(), std::size_t(stop - text.c_str()));
  const char* const after = begin + read.size();
  const bool has_digits = read.find_first_of("0123456789") != std::string_view::npos;
  if (has_digits && (std::isinf(number) || (number == 0 && is_not_zero(read))))
    return {after, std::errc::result_out_of_range};
  value = number;
  return {after, std::errc()};
}

}  // namespace

std::from_chars_result scan_by_strtod(const char* begin, const char* end, float& value) {
  return scan(begin, end, value);
}
std::from_chars_result scan_by_strtod(const char* begin, const char* end, double& value) {
  return scan(begin, end, value);
}

}  // namespace ngs
