#pragma once
// The minimum cut of a picture's grid of 8 neighbours, by the search trees of Boykov and Kolmogorov (2004): a forest
// from each side grows until the two meet, flow saturates the path, and what lost its parent is adopted or set free.
#include <array>
#include <cstdint>
#include <vector>

namespace ngs {

/// Neighbours of a pixel in the order of the search, as offsets in x and y. Of several cuts of the same capacity the
/// order decides; it is the order of OpenCV's grabCut, which gives the same cut.
struct GridStep {
  int x, y;
};
inline constexpr std::array<GridStep, 8> kGridSteps{
    {{1, 1}, {0, 1}, {-1, 1}, {1, 0}, {1, -1}, {0, -1}, {-1, -1}, {-1, 0}}};
/// The step back.
inline constexpr std::array<std::uint8_t, 8> kGridBack{6, 5, 4, 7, 2, 1, 0, 3};

class GridCut {
 public:
  /// At least one pixel each way; width_px·height_px below 2^30.
  GridCut(int width_px, int height_px);

  /// Capacity from the source, less that to the sink; NaN and infinity: more than all flow.
  void set_terminal(int x, int y, double surplus) { surplus_[at(x, y)] = surplus; }
  /// Capacity both ways between a pixel and its neighbour in the picture; not negative.
  void link(int x, int y, std::size_t step, double capacity);
  /// Computes the cut; to be called once.
  void cut();
  /// After cut(): whether the pixel is on the side of the source.
  bool is_source_side(int x, int y) const { return !of_sink_[at(x, y)]; }

 private:
  // A parent is a step, or one of these.
  static constexpr std::uint8_t kFree = 8, kTerminal = 9, kOrphan = 10;
  static constexpr int kEnd = -1;  // of the queue; 0, a pixel of the margin: not queued

  std::size_t at(int x, int y) const { return std::size_t(y + 1) * std::size_t(stride_) + std::size_t(x + 1); }
  int neighbour(int p, std::size_t step) const { return p + offset_[step]; }
  double& capacity(int p, std::size_t step) { return capacity_[8 * std::size_t(p) + step]; }
  /// Residual capacity in the direction of flow, between a pixel of a tree and its neighbour away from the root.
  double outwards(int p, std::size_t step, bool of_sink) {
    return of_sink ? capacity(neighbour(p, step), kGridBack[step]) : capacity(p, step);
  }
  void start();
  bool grow();
  bool grow_from(int p);
  void enqueue(int p);
  double bottleneck();
  double bottleneck_to_root(int p, bool of_sink, double least);
  void augment();
  void augment_to_root(int p, bool of_sink, double flow);
  void adopt();
  int distance_to_root(int p) const;
  void keep_distances(int p, int distance);
  void set_free(int p);

  int stride_;
  std::array<int, 8> offset_{};
  // Per pixel, with a margin of one free pixel on every side.
  std::vector<double> capacity_;  // [8] residual, by step
  std::vector<double> surplus_;   // residual from the source (positive) or to the sink (negative)
  std::vector<std::uint8_t> of_sink_, parent_;
  std::vector<int> next_;              // in the queue of pixels that may grow
  std::vector<int> distance_, round_;  // to the root, and when it was last known
  std::vector<int> orphans_;
  int first_ = kEnd, last_ = 0, now_ = 0;
  int meets_at_ = 0;            // the trees meet between this pixel, of the source,
  std::size_t meets_step_ = 0;  // and its neighbour
};

}  // namespace ngs
