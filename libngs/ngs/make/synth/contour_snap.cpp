#include "ngs/make/synth/contour_snap.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "ngs/backend/for_each.h"

namespace ngs::synth {
namespace {

constexpr int kMinMove_px = 2;  // nearer edges are the blurred contour itself

struct Displacement {
  double x_px = 0, y_px = 0;
};

class ContourSnap {
 public:
  ContourSnap(const Exec& exec, const ImageU16& labels, const ImageF& photo, double reach_px)
      : exec_(exec), labels_(labels), photo_(photo), reach_px_(reach_px), w_(labels.width_px), h_(labels.height_px) {
    contour_ = per_pixel<std::uint8_t>([&](int x, int y) { return std::uint8_t(is_contour(x, y)); });
    gradient_ = per_pixel<float>([&](int x, int y) { return gradient(x, y); });
    near_contour_ = per_pixel<std::uint8_t>([&](int x, int y) {
      bool near = false;
      for_each_in_disc(kMinMove_px - 0.5, x, y, [&](int dx, int dy) { near |= contour_[at(x + dx, y + dy)]; });
      return std::uint8_t(near);
    });
    move_ = per_pixel<Displacement>(
        [&](int x, int y) { return contour_[at(x, y)] ? nearest_wrong_edge(x, y) : Displacement{}; });
  }

  ImageU16 result() const {
    ImageU16 out(w_, h_, 1);
    for_each_index(exec_, h_, [&](std::int64_t row) {
      const int y = int(row);
      for (int x = 0; x < w_; ++x) {
        const Displacement d = smoothed(x, y);
        out.at(x, y) = labels_.at(std::clamp(int(std::lround(x - d.x_px)), 0, w_ - 1),
                                  std::clamp(int(std::lround(y - d.y_px)), 0, h_ - 1));
      }
    });
    return out;
  }

 private:
  /// Visits the offsets (dx, dy) of the disc around (x, y) that lie in the image.
  template <class Visit>
  void for_each_in_disc(double radius_px, int x, int y, const Visit& visit) const {
    const int reach = int(std::floor(radius_px));
    for (int dy = std::max(-reach, -y); dy <= std::min(reach, h_ - 1 - y); ++dy)
      for (int dx = std::max(-reach, -x); dx <= std::min(reach, w_ - 1 - x); ++dx)
        if (dx * dx + dy * dy <= radius_px * radius_px) visit(dx, dy);
  }

  std::size_t at(int x, int y) const { return std::size_t(y) * std::size_t(w_) + std::size_t(x); }

  template <class T, class Of>
  std::vector<T> per_pixel(const Of& of) const {
    std::vector<T> out(std::size_t(w_) * std::size_t(h_));
    for_each_index(exec_, h_, [&](std::int64_t row) {
      for (int x = 0; x < w_; ++x) out[at(x, int(row))] = of(x, int(row));
    });
    return out;
  }

  bool is_contour(int x, int y) const {
    const std::uint16_t own = labels_.at(x, y);
    return (x + 1 < w_ && labels_.at(x + 1, y) != own) || (y + 1 < h_ && labels_.at(x, y + 1) != own) ||
           (x > 0 && labels_.at(x - 1, y) != own) || (y > 0 && labels_.at(x, y - 1) != own);
  }

  /// Gradient magnitude by central differences, summed over the channels.
  float gradient(int x, int y) const {
    if (x == 0 || y == 0 || x + 1 == w_ || y + 1 == h_) return 0;
    float sum = 0;
    for (int c = 0; c < photo_.channels; ++c)
      sum +=
          std::hypot(photo_.at(x + 1, y, c) - photo_.at(x - 1, y, c), photo_.at(x, y + 1, c) - photo_.at(x, y - 1, c));
    return std::isfinite(sum) ? sum : 0;
  }

  Displacement nearest_wrong_edge(int x, int y) const {
    float own = 0;
    for_each_in_disc(1.5, x, y, [&](int dx, int dy) { own = std::max(own, gradient_[at(x + dx, y + dy)]); });
    float strongest = kSnapRatio * own;
    Displacement best;
    for_each_in_disc(reach_px_, x, y, [&](int dx, int dy) {
      const std::size_t q = at(x + dx, y + dy);
      if (near_contour_[q] || !(gradient_[q] > strongest)) return;
      strongest = gradient_[q];
      best = {double(dx), double(dy)};
    });
    return best;
  }

  /// Weighted mean of the contour's displacements near (x, y), so that contours stay connected.
  Displacement smoothed(int x, int y) const {
    double weight = 0;
    Displacement sum;
    for_each_in_disc(2 * reach_px_, x, y, [&](int dx, int dy) {
      const std::size_t q = at(x + dx, y + dy);
      if (!contour_[q]) return;
      const double w = std::exp(-(dx * dx + dy * dy) / (reach_px_ * reach_px_));
      weight += w;
      sum.x_px += w * move_[q].x_px;
      sum.y_px += w * move_[q].y_px;
    });
    return weight > 0 ? Displacement{sum.x_px / weight, sum.y_px / weight} : Displacement{};
  }

  const Exec& exec_;
  const ImageU16& labels_;
  const ImageF& photo_;
  double reach_px_;
  int w_, h_;
  std::vector<std::uint8_t> contour_, near_contour_;
  std::vector<float> gradient_;
  std::vector<Displacement> move_;  // 0 except for contour pixels
};

}  // namespace

ImageU16 snap_contours(const Exec& exec, const ImageU16& labels, const ImageF& photo, double reach_px) {
  return ContourSnap(exec, labels, photo, reach_px).result();
}

}  // namespace ngs::synth
