// Agreement of masks is measured in the box where either mask has foreground. The pixels outside must not matter.
#include "ngs/ops/image/mask_pair.h"

#include <doctest/doctest.h>

#include "support/random.h"

namespace ngs {
namespace {

constexpr int kWidth_px = 113, kHeight_px = 71, kObjects = 4;  // a band of 3 px; for a part alone it would be 1 px
constexpr std::size_t kPixels = std::size_t(kWidth_px) * kHeight_px;

struct Planes {
  ImageF label{kWidth_px, kHeight_px, kObjects};
  ViewMasks masks{kWidth_px, kHeight_px, {}, {}, true};

  /// Blobs, some cut by the image border, a single pixel, and an object without foreground.
  explicit Planes(std::uint64_t seed) {
    test::Random random(seed);
    masks.target.assign(kObjects, std::vector<float>(kPixels));
    for (int k = 0; k + 1 < kObjects; ++k) {
      blob(random, [&](std::size_t p) -> float& { return label.data[p * kObjects + std::size_t(k)]; });
      if (k > 0) blob(random, [&](std::size_t p) -> float& { return masks.target[std::size_t(k)][p]; });
    }
    masks.target[0][kPixels - 1] = 1;
    masks.known.assign(kPixels, 1);
    for (std::size_t p = 0; p < kPixels; p += 7) masks.known[p] = 0;
  }
  template <class F>
  static void blob(test::Random& random, const F& at) {
    const double x0 = random.uniform(0, kWidth_px), y0 = random.uniform(0, kHeight_px), r = random.uniform(2, 9);
    for (int y = 0; y < kHeight_px; ++y)
      for (int x = 0; x < kWidth_px; ++x) {
        const double d = (x - x0) * (x - x0) + (y - y0) * (y - y0);
        at(std::size_t(y) * kWidth_px + std::size_t(x)) = d < r * r ? 0.9f : 0.2f;
      }
  }
};

/// 0/1 plane of the whole image.
std::vector<std::uint8_t> full_plane(const Planes& of, std::size_t k, bool rendered) {
  std::vector<std::uint8_t> plane(kPixels);
  for (std::size_t p = 0; p < kPixels; ++p)
    plane[p] = of.masks.known[p] && (rendered ? label_is_foreground(of.label.data[p * kObjects + k])
                                              : mask_is_foreground(of.masks.target[k][p]));
  return plane;
}

}  // namespace

TEST_CASE("mask pairs: agreement in the foreground box equals agreement in the whole image") {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    CAPTURE(seed);
    const Planes of(seed);
    const std::vector<ForegroundBox> boxes = foreground_boxes(of.label);
    REQUIRE(boxes.size() == kObjects);
    for (std::size_t k = 0; k < kObjects; ++k) {
      const MaskPair pair(of.label, of.masks, k, boxes[k]);
      const std::vector<std::uint8_t> rendered = full_plane(of, k, true), own = full_plane(of, k, false);
      const MaskPlane a{rendered.data(), kWidth_px, kHeight_px}, b{own.data(), kWidth_px, kHeight_px};
      const Confusion part = pair.counts({}), all = confusion({}, a, b);
      CHECK(part.both_empty() == all.both_empty());
      if (!all.both_empty()) CHECK(iou(part) == iou(all));
      CHECK(pair.biou({}) == boundary_iou({}, chessboard_distance(a), chessboard_distance(b), kWidth_px,
                                          band_width_px(0.02, kWidth_px, kHeight_px)));
    }
    CHECK(boxes[kObjects - 1].empty());
    CHECK(MaskPair(of.label, of.masks, kObjects - 1, boxes[kObjects - 1]).rendered.empty());
  }
}

}  // namespace ngs
