#pragma once
// A vector with uninitialised new entries. The system clears large columns page by page on first touch. Without
// initialisation, the threads that write a column also touch it first, and touch it only once.
#include <memory>
#include <new>
#include <utility>
#include <vector>

namespace ngs {

/// std::allocator, except that an entry constructed without a value is default-initialised: a
/// number stays uninitialised.
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

/// resize() leaves new entries uninitialised.
template <class T>
using RawColumn = std::vector<T, DefaultInit<T>>;

}  // namespace ngs
