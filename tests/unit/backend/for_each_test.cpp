#include "ngs/backend/for_each.h"

#include <doctest/doctest.h>

#include <new>
#include <string>
#include <vector>

namespace ngs {
namespace {

TEST_CASE("for_each visits every index once with any number of threads") {
  for (const int threads : {1, 2, 3, 7})
    for (const std::int64_t n : {0, 1, 2, 6, 7, 1000}) {
      CAPTURE(threads);
      CAPTURE(n);
      std::vector<int> visits(std::size_t(n), 0), tasks = visits;
      for_each_index({.threads = threads}, n, [&](std::int64_t i) { ++visits[std::size_t(i)]; });
      for_each_task({.threads = threads}, n, [&](std::int64_t i) { ++tasks[std::size_t(i)]; });
      CHECK(visits == std::vector<int>(std::size_t(n), 1));
      CHECK(tasks == visits);
    }
}

// Out of memory, a tool must return its exit code; an exception in an OpenMP region would call std::terminate.
TEST_CASE("for_each rethrows an exception of a kernel to the caller") {
  for (const int threads : {1, 3}) {
    CAPTURE(threads);
    CHECK_THROWS_AS(for_each_index({.threads = threads}, 100,
                                   [](std::int64_t i) {
                                     if (i == 70) throw std::bad_alloc();
                                   }),
                    std::bad_alloc);
    std::string first;
    try {
      for_each_task({.threads = threads}, 100, [](std::int64_t i) {
        if (i % 10 == 3) throw std::to_string(i);
      });
    } catch (const std::string& thrown) {
      first = thrown;
    }
    CHECK(first == "3");
  }
}

}  // namespace
}  // namespace ngs
