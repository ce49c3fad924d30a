#pragma once
// The algorithms of std::ranges that ngs uses, and other parts of C++20 that the C++ library of Emscripten 3.1.6 lacks.
// Included before everything else, in the build for a browser only.
#ifdef __cplusplus
#include <version>
#if defined(_LIBCPP_VERSION) && _LIBCPP_VERSION < 15000
#include <algorithm>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <iterator>
#include <memory>
#include <utility>

#ifndef __cpp_lib_bit_cast
_LIBCPP_BEGIN_NAMESPACE_STD
template <class To, class From>
constexpr To bit_cast(const From& from) noexcept {
  return __builtin_bit_cast(To, from);
}
_LIBCPP_END_NAMESPACE_STD
#endif

_LIBCPP_BEGIN_NAMESPACE_STD
template <class T>
unique_ptr<T> make_unique_for_overwrite(size_t n) {
  return unique_ptr<T>(new remove_extent_t<T>[n]);
}
/// The fewest digits that give the same number; an exponent where %g has one.
template <class T>
to_chars_result web_to_chars(char* begin, char* end, T value) {
  int size = 0;
  for (int digits = 1; digits <= 17; ++digits) {
    size = snprintf(begin, size_t(end - begin), "%.*g", digits, double(value));
    if (T(strtod(begin, nullptr)) == value) break;
  }
  return {begin + size, errc()};
}
inline to_chars_result to_chars(char* begin, char* end, float value) { return web_to_chars(begin, end, value); }
inline to_chars_result to_chars(char* begin, char* end, double value) { return web_to_chars(begin, end, value); }
inline to_chars_result to_chars(char* begin, char* end, double value, chars_format, int digits) {
  return {begin + snprintf(begin, size_t(end - begin), "%.*e", digits, value), errc()};
}

namespace ranges {

struct WebSame {
  template <class T>
  constexpr T&& operator()(T&& x) const noexcept {
    return static_cast<T&&>(x);
  }
};
template <class Is, class P>
auto web_test(Is& is, P& p) {
  return [&is, &p](const auto& x) { return bool(std::invoke(is, std::invoke(p, x))); };
}
template <class C, class P>
auto web_order(C& c, P& p) {
  return [&c, &p](const auto& a, const auto& b) { return bool(std::invoke(c, std::invoke(p, a), std::invoke(p, b))); };
}

template <class R, class T, class P = WebSame>
constexpr auto find(R&& r, const T& value, P p = {}) {
  return std::find_if(std::begin(r), std::end(r), [&](const auto& x) { return std::invoke(p, x) == value; });
}
template <class R, class Is, class P = WebSame>
constexpr auto find_if(R&& r, Is is, P p = {}) {
  return std::find_if(std::begin(r), std::end(r), web_test(is, p));
}
template <class R, class Is, class P = WebSame>
constexpr bool any_of(R&& r, Is is, P p = {}) {
  return std::any_of(std::begin(r), std::end(r), web_test(is, p));
}
template <class R, class Is, class P = WebSame>
constexpr bool all_of(R&& r, Is is, P p = {}) {
  return std::all_of(std::begin(r), std::end(r), web_test(is, p));
}
template <class R, class Is, class P = WebSame>
constexpr bool none_of(R&& r, Is is, P p = {}) {
  return std::none_of(std::begin(r), std::end(r), web_test(is, p));
}
template <class R, class T, class P = WebSame>
constexpr auto count(R&& r, const T& value, P p = {}) {
  return std::count_if(std::begin(r), std::end(r), [&](const auto& x) { return std::invoke(p, x) == value; });
}
template <class R, class Is, class P = WebSame>
constexpr auto count_if(R&& r, Is is, P p = {}) {
  return std::count_if(std::begin(r), std::end(r), web_test(is, p));
}
template <class R, class C = std::less<>, class P = WebSame>
constexpr void sort(R&& r, C c = {}, P p = {}) {
  std::sort(std::begin(r), std::end(r), web_order(c, p));
}
template <class R, class C = std::less<>, class P = WebSame>
void stable_sort(R&& r, C c = {}, P p = {}) {
  std::stable_sort(std::begin(r), std::end(r), web_order(c, p));
}
template <class R, class C = std::less<>, class P = WebSame>
constexpr auto max_element(R&& r, C c = {}, P p = {}) {
  return std::max_element(std::begin(r), std::end(r), web_order(c, p));
}
template <class R, class C = std::less<>, class P = WebSame>
constexpr auto min_element(R&& r, C c = {}, P p = {}) {
  return std::min_element(std::begin(r), std::end(r), web_order(c, p));
}
template <class I>
struct WebMinMax {
  I min, max;
};
template <class R, class C = std::less<>, class P = WebSame>
constexpr auto minmax_element(R&& r, C c = {}, P p = {}) {
  const auto [least, most] = std::minmax_element(std::begin(r), std::end(r), web_order(c, p));
  return WebMinMax<std::decay_t<decltype(least)>>{least, most};
}
template <class R>
constexpr auto minmax(R&& r) {
  const auto [least, most] = std::minmax_element(std::begin(r), std::end(r));
  return WebMinMax<std::decay_t<decltype(*least)>>{*least, *most};
}
template <class R, class C = std::less<>, class P = WebSame>
constexpr auto max(R&& r, C c = {}, P p = {}) {
  return *std::max_element(std::begin(r), std::end(r), web_order(c, p));
}
template <class R, class T, class C = std::less<>, class P = WebSame>
constexpr auto lower_bound(R&& r, const T& value, C c = {}, P p = {}) {
  return std::lower_bound(std::begin(r), std::end(r), value,
                          [&](const auto& a, const auto& b) { return bool(std::invoke(c, std::invoke(p, a), b)); });
}
template <class R, class T>
constexpr bool binary_search(R&& r, const T& value) {
  return std::binary_search(std::begin(r), std::end(r), value);
}
template <class R, class Out>
constexpr void copy(R&& r, Out out) {
  std::copy(std::begin(r), std::end(r), out);
}
template <class R, class Out>
constexpr void move(R&& r, Out out) {
  std::move(std::begin(r), std::end(r), out);
}
template <class R, class Out, class Is>
constexpr void copy_if(R&& r, Out out, Is is) {
  std::copy_if(std::begin(r), std::end(r), out, is);
}
template <class R, class Out, class F, class P = WebSame>
constexpr void transform(R&& r, Out out, F f, P p = {}) {
  std::transform(std::begin(r), std::end(r), out, [&](auto&& x) { return std::invoke(f, std::invoke(p, x)); });
}
template <class A, class B>
constexpr bool equal(A&& a, B&& b) {
  return std::equal(std::begin(a), std::end(a), std::begin(b), std::end(b));
}
template <class A, class B, class Is, class P = WebSame, class Q = WebSame>
constexpr bool equal(A&& a, B&& b, Is is, P p = {}, Q q = {}) {
  return std::equal(std::begin(a), std::end(a), std::begin(b), std::end(b), [&](const auto& x, const auto& y) {
    return bool(std::invoke(is, std::invoke(p, x), std::invoke(q, y)));
  });
}
template <class R, class T>
constexpr void replace(R&& r, const T& from, const T& to) {
  std::replace(std::begin(r), std::end(r), from, to);
}
template <class R, class Is, class T>
constexpr void replace_if(R&& r, Is is, const T& to) {
  std::replace_if(std::begin(r), std::end(r), is, to);
}
template <class R, class T>
constexpr void fill(R&& r, const T& value) {
  std::fill(std::begin(r), std::end(r), value);
}
template <class R, class F>
constexpr void for_each(R&& r, F f) {
  std::for_each(std::begin(r), std::end(r), f);
}
template <class A, class B, class Out>
constexpr void set_difference(A&& a, B&& b, Out out) {
  std::set_difference(std::begin(a), std::end(a), std::begin(b), std::end(b), out);
}

}  // namespace ranges
_LIBCPP_END_NAMESPACE_STD
#endif
#endif
