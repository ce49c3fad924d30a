#pragma once
// The name of an enum value in its table of names.
#include <cstddef>
#include <span>
#include <stdexcept>
#include <string>

#include "ngs/options/field.h"

namespace ngs {

template <class E>
std::string name_of(std::span<const NamedValue<E>> names, E value) {
  for (const NamedValue<E>& named : names)
    if (named.value == value) return std::string(named.name);
  throw std::logic_error("a value without a name");
}
template <class E, std::size_t N>
std::string name_of(const NamedValue<E> (&names)[N], E value) {
  return name_of(std::span<const NamedValue<E>>(names), value);
}

}  // namespace ngs
