#include "ngs/scene/labels/label_column.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "support/random.h"

namespace ngs {
namespace {

constexpr std::size_t kPage = LabelColumn::kPageRows;

/// Applies the same random writes, some of them repeated or of 0, to a vector and to a column.
void write_both(test::Random& random, std::vector<float>& vector, LabelColumn& column) {
  for (int n = 0; n < 4000; ++n) {
    const auto row = std::size_t(random.below(std::int64_t(vector.size())));
    const float value = random.below(4) == 0 ? 0.f : float(random.below(9)) / 8;
    vector[row] = value;
    column[row] = value;
  }
}

TEST_CASE("label column: after the same writes it equals a vector") {
  for (const std::size_t rows : {std::size_t(1), kPage - 1, kPage, kPage + 1, 3 * kPage + 7}) {
    CAPTURE(rows);
    test::Random random(rows);
    std::vector<float> vector(rows);
    LabelColumn column(rows, 0.f);
    write_both(random, vector, column);
    CHECK(column.values() == vector);
    CHECK(column == LabelColumn(vector));
    CHECK(std::accumulate(column.begin(), column.end(), 0.0) == std::accumulate(vector.begin(), vector.end(), 0.0));
    CHECK(std::ranges::count(column, 0.5f) == std::ranges::count(vector, 0.5f));
  }
}

TEST_CASE("label column: writing to a copy does not change the original, unchanged pages stay shared") {
  LabelColumn given(8 * kPage, 1.f);
  for (std::size_t row = 0; row < given.size(); ++row) given[row] = float(row % 7);
  const std::size_t alone = given.unshared_bytes();
  LabelColumn copy = given;
  CHECK(copy.unshared_bytes() < alone / 16);  // the list of pages only
  copy[kPage] = float(given[kPage]);          // an equal value keeps the page shared
  CHECK(copy.unshared_bytes() < alone / 16);
  copy[kPage] = 9.f;
  CHECK(float(given[kPage]) == float(kPage % 7));
  CHECK(float(copy[kPage]) == 9.f);
  CHECK(copy.unshared_bytes() < alone / 4);
  CHECK_FALSE(copy == given);
  CHECK(std::ranges::equal(std::vector<float>(copy.begin() + 2 * kPage, copy.end()),
                           std::vector<float>(given.begin() + 2 * kPage, given.end())));
}

TEST_CASE("label column: memory is proportional to the number of non-zero rows") {
  const std::size_t rows = 64 * kPage;
  LabelColumn nothing(rows, 0.f), one_in_100(rows, 0.f), all(rows, 0.f);
  for (std::size_t row = 0; row < rows; ++row) {
    all[row] = float(row + 1);
    if (row % 100 == 3) one_in_100[row] = 1.f;
    nothing[row] = 0.f;
  }
  CHECK(nothing.unshared_bytes() < rows / 32);
  CHECK(one_in_100.unshared_bytes() < rows / 2);  // of 4 bytes per row
  CHECK(all.unshared_bytes() < rows * 5);
  CHECK(LabelColumn(rows, 1.f).unshared_bytes() < rows / 32);  // one page for all
}

TEST_CASE("label column: share() merges equal pages of two columns") {
  LabelColumn a(4 * kPage, 0.f), b(4 * kPage, 0.f);
  for (std::size_t row = 0; row < a.size(); ++row) a[row] = b[row] = float(row % 5);
  b[1] = 7.f;
  const std::vector<float> before = b.values();
  const std::size_t alone = b.unshared_bytes();
  b.share(a);
  CHECK(b.values() == before);
  CHECK(b.unshared_bytes() < alone / 2);
  b[kPage] = 8.f;
  CHECK(float(a[kPage]) == float(kPage % 5));
}

TEST_CASE("label column: -0, denormals and NaN are stored") {
  const LabelColumn column{0.f, -0.f, 1e-45f, NAN};
  CHECK(std::signbit(column[1]));
  CHECK_FALSE(std::signbit(column[0]));
  CHECK(column[2] == 1e-45f);
  CHECK(std::isnan(column[3]));
}

TEST_CASE("label column: rows cut off by resize() are 0 when it grows again") {
  LabelColumn column(kPage + 20, 1.f);
  const LabelColumn whole = column;
  column.resize(kPage + 5);
  CHECK(column.size() == kPage + 5);
  column.resize(kPage + 20);
  CHECK(float(column[kPage + 4]) == 1.f);
  CHECK(float(column[kPage + 5]) == 0.f);
  column.push_back(3.f);
  CHECK(column.back() == 3.f);
  CHECK(float(whole[kPage + 19]) == 1.f);
  column.clear();
  CHECK(column.empty());
}

}  // namespace
}  // namespace ngs
