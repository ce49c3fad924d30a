#include <doctest/doctest.h>

#include <cmath>

#include "ngs/edit/finish/mask_lack.h"
#include "ngs/edit/finish/seen_hull.h"

namespace ngs::finish {
namespace {

constexpr int kImage_px = 96;

/// A disc, brighter than its checkered surroundings by `contrast`.
ImageF disc_photo(double radius, float contrast) {
  ImageF photo(kImage_px, kImage_px, 3);
  for (int y = 0; y < kImage_px; ++y)
    for (int x = 0; x < kImage_px; ++x)
      for (int c = 0; c < 3; ++c)
        photo.at(x, y, c) = std::hypot(x - 48, y - 48) < radius ? 0.5f + contrast : 0.45f + 0.1f * float((x / 5) % 2);
  return photo;
}

std::vector<GivenMask> disc_mask(double radius, int shift = 0) {
  std::vector<GivenMask> mask;
  for (int y = 0; y < kImage_px; ++y)
    for (int x = 0; x < kImage_px; ++x)
      mask.push_back(std::hypot(x - 48 - shift, y - 48) < radius ? GivenMask::kObject : GivenMask::kBackground);
  return mask;
}

int lack_of(const std::vector<std::vector<GivenMask>>& masks, const ImageF& photo) {
  MaskLack lack;
  for (const auto& mask : masks) lack.add(mask, photo);
  return lack.px();
}

TEST_CASE("masks that are too small by 3 and 5 px lack about so much; exact, larger and displaced masks lack nothing") {
  const ImageF photo = disc_photo(30, 0.4f);
  CHECK(lack_of({disc_mask(27), disc_mask(27)}, photo) == 3);
  CHECK(lack_of({disc_mask(25)}, photo) >= 4);  // chessboard distances: 5 along the axes, 3.5 along diagonals
  CHECK(lack_of({disc_mask(30)}, photo) == 0);
  CHECK(lack_of({disc_mask(33)}, photo) == 0);
  CHECK(lack_of({disc_mask(30, 3), disc_mask(30, -3)}, photo) == 0);
}

TEST_CASE("exact masks of a plain object before a texture with more contrast than its contour lack nothing") {
  ImageF photo = disc_photo(30, 0.1f);
  for (int y = 0; y < kImage_px; ++y)
    for (int x = 0; x < kImage_px; ++x)
      for (int c = 0; c < 3 && std::hypot(x - 48, y - 48) >= 30; ++c)
        photo.at(x, y, c) = (x / 2 + y / 2) % 2 ? 1.0f : 0.1f;
  CHECK(lack_of({disc_mask(30)}, photo) == 0);
}

TEST_CASE("one mask that is too small among exact ones, unknown and empty masks, and no photo: nothing is lacking") {
  const ImageF photo = disc_photo(30, 0.4f);
  CHECK(lack_of({disc_mask(30), disc_mask(27), disc_mask(30)}, photo) == 0);
  CHECK(lack_of({std::vector(kImage_px * kImage_px, GivenMask::kUnknown)}, photo) == 0);
  CHECK(lack_of({std::vector(kImage_px * kImage_px, GivenMask::kBackground)}, photo) == 0);
  CHECK(MaskLack().px() == 0);
}

using orbit::Vec;

/// The unit ball's surface, all seen, and one Gaussian more that is not.
struct BallCase {
  GaussianCloud cloud;
  std::vector<std::uint8_t> seen;

  explicit BallCase(Vec hidden) {
    for (const Vec at : orbit::even_directions(3000)) add(at, true);
    add(hidden, false);
  }
  void add(Vec at, bool is_seen) {
    const auto i = std::size_t(cloud.size());
    cloud.resize(cloud.size() + 1, 0);
    const double p[3] = {at.x, at.y, at.z};
    for (std::size_t a = 0; a < 3; ++a) {
      cloud.position[3 * i + a] = float(p[a]);
      cloud.log_scale[3 * i + a] = -3.2f;
    }
    cloud.rotation[4 * i] = 1;
    cloud.logit_opacity[i] = 5;
    cloud.usable[i] = 1;
    seen.push_back(is_seen);
  }
  SeenHull hull() const { return SeenHull({}, cloud, seen, {{0, 0, 0}, 1}); }
};

}  // namespace

TEST_CASE("a hidden Gaussian among seen ones is surplus; points outside of the seen ones are outside of their hull") {
  const BallCase c({0.9, 0, 0});
  const SeenHull hull = c.hull();
  CHECK(hull.is_surplus(3000));
  CHECK(hull.is_hidden(3000));
  CHECK(!hull.is_surplus(0));
  CHECK(!hull.is_hidden(0));
  CHECK(hull.contains({0, 0, 0}));
  CHECK(hull.contains({0.95, 0, 0}));
  CHECK(!hull.contains({1.2, 0, 0}));
  CHECK(!hull.contains({0, -1.2, 0}));
  CHECK(hull.contains({0, -3, 0}));  // beyond what is known
}

TEST_CASE("hidden Gaussians among hidden ones are no surplus: it may be the object's unseen side") {
  BallCase c({0, 0, -1});
  for (std::size_t i = 0; i < c.seen.size(); ++i) c.seen[i] = c.cloud.position[3 * i + 2] > -0.3f;
  const SeenHull hull = c.hull();
  CHECK(!hull.is_surplus(3000));
  CHECK(hull.is_hidden(3000));
}

TEST_CASE("without hidden Gaussians, with too few, or with undefined rows nothing is surplus and all is contained") {
  BallCase c({0.9, 0, 0});
  c.seen.back() = 1;
  CHECK(!c.hull().is_surplus(3000));
  CHECK(c.hull().contains({1.5, 0, 0}));
  BallCase few({0.9, 0, 0});
  few.cloud.resize(0, 0);
  few.seen.clear();
  few.add({0, 0, 0}, true);
  few.add({0, 0.1, 0}, false);
  CHECK(!few.hull().is_surplus(1));
  BallCase odd({0.9, 0, 0});
  odd.cloud.position[3 * 3000] = NAN;
  classify(odd.cloud);
  CHECK(!odd.hull().is_surplus(3000));
}

}  // namespace ngs::finish
