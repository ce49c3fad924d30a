#include "ngs/math/sparse_table.h"

#include <doctest/doctest.h>

#include <map>

#include "support/random.h"

namespace ngs {
namespace {

TEST_CASE("a sparse table equals a dense one, cell by cell, in whatever order cells are touched") {
  constexpr std::size_t kRows = 50, kColumns = 13;
  test::Random random(3);
  SparseTable<int> table(kRows);
  std::map<std::pair<std::size_t, std::size_t>, int> dense;
  for (int n = 0; n < 300; ++n) {
    const auto row = std::size_t(random.below(kRows)), column = std::size_t(random.below(kColumns));
    table.touch(row, column) += n;
    dense[{row, column}] += n;
  }
  for (std::size_t row = 0; row < kRows; ++row) {
    std::size_t next = 0, cells = 0;
    table.for_each_in(row, [&](std::size_t column, int cell) {
      CHECK(column >= next);  // sorted by column
      CHECK(dense.at({row, column}) == cell);
      next = column + 1;
      ++cells;
    });
    for (std::size_t column = 0; column < kColumns; ++column) {
      const auto wanted = dense.find({row, column});
      const int* found = table.find(row, column);
      REQUIRE((found != nullptr) == (wanted != dense.end()));
      if (found) {
        CHECK(*found == wanted->second);
        --cells;
      }
    }
    CHECK(cells == 0);
  }
}

TEST_CASE("every deferred insert of a sparse table is added exactly once") {
  struct Count {
    int of = 0;
    void add(const Count& other) { of += other.of; }
  };
  SparseTable<Count> table(2);
  std::vector<SparseTable<Count>::Insert> deferred_inserts;
  table.add(1, 2, {4}, deferred_inserts);
  table.add(1, 2, {5}, deferred_inserts);
  CHECK(table.find(1, 2) == nullptr);  // not touched yet
  CHECK(deferred_inserts.size() == 2);
  table.add(deferred_inserts);
  REQUIRE(table.find(1, 2) != nullptr);
  CHECK(table.find(1, 2)->of == 9);
  deferred_inserts.clear();
  table.add(1, 2, {1}, deferred_inserts);
  CHECK(deferred_inserts.empty());
  CHECK(table.find(1, 2)->of == 10);
}

TEST_CASE("a copy of a sparse table is independent of the original") {
  SparseTable<int> table(2);
  table.touch(0, 1) = 5;
  SparseTable<int> copy = table;
  copy.touch(0, 0) = 7;
  copy.touch(0, 1) = 6;
  CHECK(table.find(0, 0) == nullptr);
  CHECK(*table.find(0, 1) == 5);
  CHECK(*copy.find(0, 1) == 6);
}

}  // namespace
}  // namespace ngs
