#include "ngs/edit/fill/occluder.h"

#include <cmath>

namespace ngs {
namespace {

using orbit::Vec;

constexpr double kCellsAcross = 72;  // along the diagonal of the object
constexpr double kBlocking = 0.25;

}  // namespace

Occluder::Occluder(const Rim& rim) {
  if (rim.object.count() == 0 || !(rim.diagonal > 0)) return;
  side_ = rim.diagonal / kCellsAcross;
  low_ = rim.box.low - Vec{2 * side_, 2 * side_, 2 * side_};
  const Vec size = rim.box.high - low_;
  x_ = std::int64_t(size.x / side_) + 3;
  y_ = std::int64_t(size.y / side_) + 3;
  z_ = std::int64_t(size.z / side_) + 3;
  reach_ = 1.1 * rim.diagonal;
  occupied_.assign(std::size_t(x_ * y_ * z_), 0);
  for (std::size_t i = 0; i < rim.object.count(); ++i) {
    if (rim.object.opacity[i] < kBlocking) continue;
    const int margin = rim.object.size[i] >= 0.5 * side_;
    for (int k = 0; k < 27; ++k) {
      const int across = k % 3, along = k / 3 % 3, up = k / 9;
      const Vec step{double(across - 1), double(along - 1), double(up - 1)};
      const std::int64_t cell = cell_of(rim.object.position[i] + double(margin) * side_ * step);
      if (cell >= 0) occupied_[std::size_t(cell)] = 1;
    }
  }
}

std::int64_t Occluder::cell_of(Vec p) const {
  const double x = std::floor((p.x - low_.x) / side_), y = std::floor((p.y - low_.y) / side_),
               z = std::floor((p.z - low_.z) / side_);
  if (!(x >= 0 && y >= 0 && z >= 0 && x < double(x_) && y < double(y_) && z < double(z_))) return -1;
  return (std::int64_t(z) * y_ + std::int64_t(y)) * x_ + std::int64_t(x);
}

bool Occluder::contains(Vec p) const {
  const std::int64_t cell = cell_of(p);
  return cell >= 0 && occupied_[std::size_t(cell)];
}

bool Occluder::hides(Vec from, Vec direction) const {
  if (occupied_.empty()) return false;
  for (double along = 1.5 * side_; along < reach_ + 2 * side_; along += 0.75 * side_)
    if (contains(from + along * direction)) return true;
  return false;
}

}  // namespace ngs
