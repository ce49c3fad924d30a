#pragma once
// A vector whose new entries hold anything. Large columns are cleared by the system when they are first touched, a page
// at a time: they are best touched first by the threads that write them, and once.
#include <memory>
#include <new>
#include <utility>
#include <vector>

namespace ngs {

/// std::allocator but for entries that are asked for without a value: they get none.
template <class T>
struct DefaultInit : std::allocator<T> {
  DefaultInit() = default;
  template <class U>
  DefaultInit(const DefaultInit<U>&) {}
  template <class U>
  void construct(U* at) {
    ::new (static_cast<void*>(at)) U;
  }
  template <class U, class... Values>
  void construct(U* at, Values&&... values) {
    ::new (static_cast<void*>(at)) U(std::forward<Values>(values)...);
  }
};

/// resize() leaves what it adds as it is.
template <class T>
using RawColumn = std::vector<T, DefaultInit<T>>;

}  // namespace ngs
