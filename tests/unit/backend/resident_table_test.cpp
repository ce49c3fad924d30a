#include "ngs/backend/resident_table.h"

#include <doctest/doctest.h>

#include <stdexcept>
#include <vector>

#include "support/host_launcher.h"

namespace ngs {

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
    part.to(host.data() + 1), other.to(host.data() + 2);
    CHECK(launcher.traffic().up_bytes == 2 * sizeof(float));
    CHECK(launcher.traffic().down_bytes == 0);
    CHECK(host == std::vector<float>{1, 2, 3, 4});
    launcher.resident.erase(host.data());
    home.to(host);
  }
  CHECK(host == std::vector<float>{1, 2, 7, 8});
}

}  // namespace ngs
