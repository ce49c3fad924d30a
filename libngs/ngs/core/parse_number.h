#pragma once
// Parses numbers in the form that std::from_chars reads: no leading blanks or '+', no hexadecimal, '.' in every locale.
// libc++ has std::from_chars for floating-point numbers only from version 20 on.
#include <charconv>
#include <string_view>
#include <system_error>
#include <type_traits>

namespace ngs {

/// std::from_chars(begin, end, value) by means of the C library: same values, ends and errors.
std::from_chars_result scan_by_strtod(const char* begin, const char* end, float& value);
std::from_chars_result scan_by_strtod(const char* begin, const char* end, double& value);

/// std::from_chars with any C++ library.
template <class T>
std::from_chars_result scan_number(const char* begin, const char* end, T& value) {
#if defined(_LIBCPP_VERSION) && _LIBCPP_VERSION < 200000
  if constexpr (std::is_floating_point_v<T>)
    return scan_by_strtod(begin, end, value);
  else
#endif
    return std::from_chars(begin, end, value);
}

/// True if the whole text is a number in the range of T, which `value` then holds.
template <class T>
bool parse_number(std::string_view text, T& value) {
  const auto [stop, error] = scan_number(text.data(), text.data() + text.size(), value);
  return error == std::errc() && stop == text.data() + text.size();
}

}  // namespace ngs
