
#include <doctest/doctest.h>

#include <cmath>

#include "ngs/edit/select/touched_pieces.h"

namespace ngs {
namespace {

/// Two lattices of 8 x 8 x 8 compact Gaussians, 0.1 apart: the object above z = 0, the background below; and one
/// Gaussian of the object at its lower side, `length` long along `axis`.
struct Statue {
  GaussianCloud cloud;
  std::vector<std::uint8_t> object;

  Statue(int axis, double length, bool has_background = true) {
    const std::size_t block = 512, count = block * (has_background ? 2 : 1) + 1;
    cloud.resize(std::int64_t(count), 0);
    object.assign(count, 0);
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t k = i % block;
      const bool below = i >= block && i + 1 < count;
      const double z = 0.05 + 0.1 * double(k / 64);
      const double at[3] = {0.1 * double(k % 8), 0.1 * double(k / 8 % 8), below ? -z : z};
      for (std::size_t a = 0; a < 3; ++a) {
        cloud.position[3 * i + a] = float(at[a]);
        cloud.log_scale[3 * i + a] = std::log(0.02f);
      }
      cloud.rotation[4 * i] = 1, cloud.logit_opacity[i] = 3;
      object[i] = !below;
    }
    const std::size_t last = count - 1;
    const float at[3] = {0.35f, 0.35f, 0.05f};
    for (std::size_t a = 0; a < 3; ++a) cloud.position[3 * last + a] = at[a];
    cloud.log_scale[3 * last + std::size_t(axis)] = float(std::log(length));
    classify(cloud);
  }
  std::uint32_t last() const { return std::uint32_t(object.size() - 1); }
};

using RowList = std::vector<std::uint32_t>;

}  // namespace

TEST_CASE("a long Gaussian that reaches into the background is a needle, one along the cut or inside is none") {
  const Statue down(2, 0.3);
  CHECK(needles_beyond({}, down.cloud, down.object, 0.2) == RowList{down.last()});
  const Statue along(0, 0.15);
  CHECK(needles_beyond({}, along.cloud, along.object, 0.2).empty());
  const Statue compact(2, 0.02);
  CHECK(needles_beyond({}, compact.cloud, compact.object, 0.2).empty());
  CHECK(needles_beyond({}, down.cloud, down.object, 0).empty());
}

TEST_CASE("a long Gaussian that ends in empty space, as a whisker, is no needle") {
  const Statue whisker(2, 0.3, false);
  CHECK(needles_beyond({}, whisker.cloud, whisker.object, 0.2).empty());
  const Statue sideways(0, 0.6);  // beyond both blocks
  CHECK(needles_beyond({}, sideways.cloud, sideways.object, 0.2).empty());
}

TEST_CASE("a long Gaussian among sparse ones of the object is no needle, although it ends far from all of them") {
  Statue statue(2, 0.3);
  const std::size_t last = statue.last(), foot = 40;  // 40 Gaussians 0.4 apart, below the block, in the background
  statue.cloud.resize(std::int64_t(last + 1 + foot), 0);
  statue.object.resize(last + 1 + foot, 1);
  for (std::size_t k = 0; k < foot; ++k) {
    const std::size_t i = last + 1 + k;
    const double at[3] = {0.4 * double(k % 4) - 0.25, 0.4 * double(k / 4 % 5) - 0.45, -0.3 - 0.4 * double(k / 20)};
    for (std::size_t a = 0; a < 3; ++a) {
      statue.cloud.position[3 * i + a] = float(at[a]);
      statue.cloud.log_scale[3 * i + a] = std::log(0.1f);
    }
    statue.cloud.rotation[4 * i] = 1, statue.cloud.logit_opacity[i] = 3;
  }
  classify(statue.cloud);
  CHECK(needles_beyond({}, statue.cloud, statue.object, 0.2).empty());
}

TEST_CASE("needles are the same for any number of threads, and touched pieces do not have them") {
  const Statue statue(2, 0.3);
  Exec one, three;
  one.threads = 1, three.threads = 3;
  CHECK(needles_beyond(one, statue.cloud, statue.object, 0.2) ==
        needles_beyond(three, statue.cloud, statue.object, 0.2));
  ViewSums stroke{0, false, {}, {}};
  const double weight = 1;
  for (std::uint32_t i = 0; i < 20; ++i) stroke.add(i, &weight);
  const PieceSelection pieces = touched_pieces({}, statue.cloud, statue.object, std::vector{stroke});
  CHECK(pieces.needles == 1);
  CHECK(pieces.removed == 0);
  CHECK(pieces.object[statue.last()] == 0);
  CHECK(pieces.object[0] == 1);
}

}  // namespace ngs
