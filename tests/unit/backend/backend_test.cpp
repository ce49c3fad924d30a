#include <doctest/doctest.h>

#include <new>
#include <stdexcept>
#include <string>
#include <vector>

#include "ngs/backend/for_each.h"
#include "ngs/backend/resident_table.h"
#include "support/host_launcher.h"

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

TEST_CASE("resident table: finds an array and its parts, and no other memory; a straddling range is an error") {
  std::vector<float> host(12);
  char device[4 * sizeof(float)];
  ResidentTable table;
  CHECK(table.find(host.data(), sizeof(float)) == nullptr);
  table.insert(&host[4], {sizeof device, device});
  CHECK(table.find(&host[4], sizeof device) == device);
  CHECK(table.find(&host[6], 2 * sizeof(float)) == device + 2 * sizeof(float));
  CHECK(table.find(&host[0], 4 * sizeof(float)) == nullptr);
  CHECK(table.find(&host[8], 4 * sizeof(float)) == nullptr);
  CHECK(table.find(&host[4], 0) == nullptr);
  CHECK(table.find(nullptr, 4) == nullptr);
  CHECK_THROWS_AS(table.find(&host[3], 2 * sizeof(float)), std::logic_error);
  CHECK_THROWS_AS(table.find(&host[7], 2 * sizeof(float)), std::logic_error);
  CHECK_THROWS_AS(table.find(&host[0], 12 * sizeof(float)), std::logic_error);
  CHECK_THROWS_AS(table.insert(&host[4], {sizeof device, device}), std::logic_error);
  CHECK_THROWS_AS(table.erase(&host[5]), std::logic_error);
  CHECK(table.erase(&host[4]).device == device);
  CHECK(table.find(&host[4], sizeof device) == nullptr);
}

TEST_CASE("device buffer: a resident argument is used in place, a result reaches it without a copy to the host") {
  test::HostLauncher launcher;
  using Buffer = DeviceBuffer<test::HostLauncher, float>;
  std::vector<float> host{1, 2, 3, 4};
  {
    const Buffer home(launcher, host);
    launcher.resident.insert(host.data(), {4 * sizeof(float), reinterpret_cast<char*>(home.data())});
    launcher.traffic() = {};
    const Buffer part(launcher, host.data() + 1, 2), other(launcher, std::vector<float>{7, 8});
    CHECK(part.data() == home.data() + 1);
    part.to(host.data() + 1);
    other.to(host.data() + 2);
    CHECK(launcher.traffic().up_bytes == 2 * sizeof(float));
    CHECK(launcher.traffic().down_bytes == 0);
    CHECK(host == std::vector<float>{1, 2, 3, 4});
    launcher.resident.erase(host.data());
    home.to(host);
  }
  CHECK(host == std::vector<float>{1, 2, 7, 8});
}

}  // namespace ngs
