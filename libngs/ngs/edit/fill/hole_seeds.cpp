#include "ngs/edit/fill/hole_seeds.h"

#include <algorithm>
#include <cmath>

#include "ngs/math/sh.h"
#include "ngs/scene/geometry/unproject.h"

namespace ngs {
namespace {

constexpr int kCell_px = 4;
constexpr float kSeedCovered = 0.5f;                    // alpha
constexpr double kSeedWidth_cells = 0.6;                // standard deviation of a seed, cells
constexpr float kSeedLogitOpacity = 2.2f;               // 0.9
constexpr int kSweeps = 400;                            // of successive over-relaxation, at most
constexpr double kRelaxation = 1.8, kConverged = 1e-7;  // of the largest inverse depth

/// The view in cells.
class HoleGrid {
 public:
  explicit HoleGrid(const HolePicture& view)
      : columns_((view.camera.width_px + kCell_px - 1) / kCell_px),
        rows_((view.camera.height_px + kCell_px - 1) / kCell_px),
        inverse_(std::size_t(columns_) * std::size_t(rows_)) {
    for (int y = 0; y < rows_; ++y)
      for (int x = 0; x < columns_; ++x) classify(view, x, y);
    reach();
  }

  /// The cells to be seeded, row by row.
  const std::vector<int>& empty() const { return empty_; }
  int columns() const { return columns_; }
  double inverse_depth(int cell) const { return inverse_[std::size_t(cell)]; }

  /// Makes the inverse depth of the empty cells harmonic.
  void solve() {
    double largest = 0;
    for (const double d : inverse_) largest = std::max(largest, d);
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
      double most = 0;
      for (const int cell : empty_) {
        double sum = 0, count = 0;
        for_sides(cell, [&](int next) {
          if (!(inverse_[std::size_t(next)] > 0)) return;
          sum += inverse_[std::size_t(next)];
          ++count;
        });
        double& d = inverse_[std::size_t(cell)];
        const double change = kRelaxation * (sum / count - d);
        d = std::max(d + change, 1e-3 * largest);
        most = std::max(most, std::abs(change));
      }
      if (most <= kConverged * largest) return;
    }
  }

 private:
  /// Sets the mean inverse depth of a cell's covered pixels, or lists the cell as empty.
  void classify(const HolePicture& view, int column, int row) {
    const int w = view.camera.width_px, h = view.camera.height_px, cell = row * columns_ + column;
    double sum = 0, count = 0;
    for (int y = row * kCell_px; y < std::min(h, (row + 1) * kCell_px); ++y)
      for (int x = column * kCell_px; x < std::min(w, (column + 1) * kCell_px); ++x) {
        const float alpha = view.around.alpha.at(x, y), depth = view.around.depth.at(x, y);
        if (alpha >= kSeedCovered && depth > 0) {
          sum += double(alpha) / double(depth);
          ++count;
        }
      }
    const int x = std::min(w - 1, column * kCell_px + kCell_px / 2), y = std::min(h - 1, row * kCell_px + kCell_px / 2);
    const bool is_hole = view.hole[std::size_t(y) * std::size_t(w) + std::size_t(x)] != 0;
    if (is_hole && !(view.around.alpha.at(x, y) >= kSeedCovered)) return empty_.push_back(cell);
    if (count > 0) inverse_[std::size_t(cell)] = sum / count;
  }

  /// Starts every empty cell with the value of the nearest covered cell; leaves out those that none reaches.
  void reach() {
    std::vector<std::uint8_t> waiting(inverse_.size());
    for (const int cell : empty_) waiting[std::size_t(cell)] = 1;
    std::vector<int> front;
    for (int cell = 0; cell < int(inverse_.size()); ++cell)
      if (inverse_[std::size_t(cell)] > 0) front.push_back(cell);
    for (std::size_t k = 0; k < front.size(); ++k)
      for_sides(front[k], [&](int next) {
        if (!waiting[std::size_t(next)]) return;
        waiting[std::size_t(next)] = 0;
        inverse_[std::size_t(next)] = inverse_[std::size_t(front[k])];
        front.push_back(next);
      });
    std::erase_if(empty_, [&](int cell) { return waiting[std::size_t(cell)] != 0; });
  }

  template <class Visit>
  void for_sides(int cell, const Visit& visit) const {
    const int x = cell % columns_, y = cell / columns_;
    if (x > 0) visit(cell - 1);
    if (x + 1 < columns_) visit(cell + 1);
    if (y > 0) visit(cell - columns_);
    if (y + 1 < rows_) visit(cell + columns_);
  }

  int columns_, rows_;
  std::vector<double> inverse_;  // [rows · columns] 1/z; 0: unknown
  std::vector<int> empty_;
};

/// Mean colour of a cell as sh_dc.
Vec3<float> colour_of_cell(const ImageF& picture, int column, int row) {
  double sum[3] = {0, 0, 0}, count = 0;
  for (int y = row * kCell_px; y < std::min(picture.height_px, (row + 1) * kCell_px); ++y)
    for (int x = column * kCell_px; x < std::min(picture.width_px, (column + 1) * kCell_px); ++x, ++count)
      for (int c = 0; c < 3; ++c) sum[c] += double(picture.at(x, y, c));
  return {float(dc_of_colour(sum[0] / count)), float(dc_of_colour(sum[1] / count)),
          float(dc_of_colour(sum[2] / count))};
}

}  // namespace

std::int64_t add_hole_seeds(const HolePicture& view, GaussianCloud& to) {
  HoleGrid grid(view);
  grid.solve();
  const Camera& c = view.camera;
  const std::int64_t first = to.size();
  to.resize(first + std::int64_t(grid.empty().size()), to.sh_degree);
  for (std::size_t k = 0; k < grid.empty().size(); ++k) {
    const std::size_t i = std::size_t(first) + k;
    const int column = grid.empty()[k] % grid.columns(), row = grid.empty()[k] / grid.columns();
    const double z = 1 / grid.inverse_depth(grid.empty()[k]);
    const double x = (column + 0.5) * kCell_px, y = (row + 0.5) * kCell_px;
    const Vec3<double> world = unproject(c, x, y, z);
    const Vec3<float> colour = colour_of_cell(view.picture, column, row);
    const double at[3] = {world.x, world.y, world.z};
    const float dc[3] = {colour.x, colour.y, colour.z};
    for (std::size_t a = 0; a < 3; ++a) {
      to.position[3 * i + a] = float(at[a]);
      to.sh_dc[3 * i + a] = dc[a];
      to.log_scale[3 * i + a] = float(std::log(kSeedWidth_cells * kCell_px * z / std::max(c.fx, c.fy)));
    }
    to.rotation[4 * i] = 1;
    to.logit_opacity[i] = kSeedLogitOpacity;
    to.usable[i] = 1;
  }
  return std::int64_t(grid.empty().size());
}

}  // namespace ngs
