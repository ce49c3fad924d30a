#include "ngs/ops/image/grid_cut_web.h"

#include <cmath>
#include <limits>

namespace ngs {
namespace {

constexpr int kNever = std::numeric_limits<int>::max();

/// `b` unless it is larger or NaN.
double smaller(double a, double b) { return a > b ? b : a; }

}  // namespace

GridCut::GridCut(int width_px, int height_px) : stride_(width_px + 2) {
  const std::size_t pixels = std::size_t(stride_) * std::size_t(height_px + 2);
  for (std::size_t k = 0; k < 8; ++k) offset_[k] = kGridSteps[k].y * stride_ + kGridSteps[k].x;
  capacity_.resize(8 * pixels);
  surplus_.resize(pixels);
  of_sink_.resize(pixels);
  parent_.assign(pixels, kFree);
  next_.resize(pixels);
  distance_.resize(pixels);
  round_.resize(pixels);
}

void GridCut::link(int x, int y, std::size_t step, double both) {
  const int p = int(at(x, y));
  capacity(p, step) = both;
  capacity(neighbour(p, step), kGridBack[step]) = both;
}

void GridCut::enqueue(int p) {
  if (next_[std::size_t(p)] != 0) return;
  next_[std::size_t(p)] = kEnd;
  if (first_ == kEnd)
    first_ = p;
  else
    next_[std::size_t(last_)] = p;
  last_ = p;
}

void GridCut::start() {
  for (int p = 0; p < int(surplus_.size()); ++p) {
    const double surplus = surplus_[std::size_t(p)];
    if (surplus == 0) continue;
    parent_[std::size_t(p)] = kTerminal;
    of_sink_[std::size_t(p)] = surplus < 0;
    distance_[std::size_t(p)] = 1;
    enqueue(p);
  }
}

/// Grows the tree of a pixel by its free neighbours. True, and the place is noted: it meets the other tree.
bool GridCut::grow_from(int p) {
  const std::size_t from = std::size_t(p);
  const bool of_sink = of_sink_[from];
  for (std::size_t k = 0; k < 8; ++k) {
    const int q = neighbour(p, k);
    const std::size_t to = std::size_t(q);
    if (outwards(p, k, of_sink) == 0) continue;
    const bool is_free = parent_[to] == kFree;
    if (!is_free && bool(of_sink_[to]) != of_sink) {
      meets_at_ = of_sink ? q : p;
      meets_step_ = of_sink ? kGridBack[k] : k;
      return true;
    }
    if (!is_free && !(distance_[to] > distance_[from] + 1 && round_[to] <= round_[from])) continue;
    parent_[to] = kGridBack[k];
    round_[to] = round_[from];
    distance_[to] = distance_[from] + 1;
    if (!is_free) continue;
    of_sink_[to] = of_sink;
    enqueue(q);
  }
  return false;
}

bool GridCut::grow() {
  while (first_ != kEnd) {
    const int p = first_;
    if (parent_[std::size_t(p)] != kFree && grow_from(p)) return true;
    first_ = next_[std::size_t(p)];
    next_[std::size_t(p)] = 0;
  }
  return false;
}

double GridCut::bottleneck_to_root(int p, bool of_sink, double least) {
  while (parent_[std::size_t(p)] < 8) {
    const std::size_t up = parent_[std::size_t(p)];
    const int above = neighbour(p, up);
    least = smaller(least, outwards(above, kGridBack[up], of_sink));
    p = above;
  }
  return smaller(least, std::fabs(surplus_[std::size_t(p)]));
}

double GridCut::bottleneck() {
  const double least = bottleneck_to_root(meets_at_, false, capacity(meets_at_, meets_step_));
  return bottleneck_to_root(neighbour(meets_at_, meets_step_), true, least);
}

void GridCut::augment_to_root(int p, bool of_sink, double flow) {
  const auto orphan = [&](int q) {
    orphans_.push_back(q);
    parent_[std::size_t(q)] = kOrphan;
  };
  while (parent_[std::size_t(p)] < 8) {
    const std::size_t up = parent_[std::size_t(p)];
    const int above = neighbour(p, up);
    double& towards_root = capacity(p, up);
    double& from_root = capacity(above, kGridBack[up]);
    (of_sink ? from_root : towards_root) += flow;
    double& left = of_sink ? towards_root : from_root;
    left -= flow;
    if (left == 0) orphan(p);
    p = above;
  }
  double& surplus = surplus_[std::size_t(p)];
  surplus += of_sink ? flow : -flow;
  if (surplus == 0) orphan(p);
}

void GridCut::augment() {
  const double flow = bottleneck();
  const int beyond = neighbour(meets_at_, meets_step_);
  capacity(meets_at_, meets_step_) -= flow;
  capacity(beyond, kGridBack[meets_step_]) += flow;
  augment_to_root(meets_at_, false, flow);
  augment_to_root(beyond, true, flow);
}

/// kNever: the path ends at an orphan.
int GridCut::distance_to_root(int p) const {
  for (int steps = 1;; ++steps) {
    const std::size_t here = std::size_t(p);
    if (round_[here] == now_) return steps + distance_[here];
    if (parent_[here] == kOrphan) return kNever;
    if (parent_[here] == kTerminal) return steps + 1;
    p = neighbour(p, parent_[here]);
  }
}

/// Notes the distances on the path from `p`, whose own is `distance`, to the root or to where they are known.
void GridCut::keep_distances(int p, int distance) {
  for (; round_[std::size_t(p)] != now_; p = neighbour(p, parent_[std::size_t(p)])) {
    round_[std::size_t(p)] = now_;
    distance_[std::size_t(p)] = distance--;
    if (parent_[std::size_t(p)] == kTerminal) return;
  }
}

/// Gives every orphan the parent of the shortest path to a root, or sets it free.
void GridCut::adopt() {
  ++now_;
  while (!orphans_.empty()) {
    const int p = orphans_.back();
    const std::size_t here = std::size_t(p);
    orphans_.pop_back();
    int shortest = kNever;
    std::uint8_t parent = kOrphan;  // until all paths are known: they may lead here
    for (std::size_t k = 0; k < 8; ++k) {
      const int q = neighbour(p, k);
      if (parent_[std::size_t(q)] == kFree || of_sink_[std::size_t(q)] != of_sink_[here]) continue;
      if (outwards(q, kGridBack[k], of_sink_[here]) == 0) continue;
      const int distance = distance_to_root(q);
      if (distance == kNever) continue;
      keep_distances(q, distance - 1);
      if (distance >= shortest) continue;
      shortest = distance;
      parent = std::uint8_t(k);
    }
    if (parent == kOrphan) {
      set_free(p);
      continue;
    }
    parent_[here] = parent;
    round_[here] = now_;
    distance_[here] = shortest;
  }
}

void GridCut::set_free(int p) {
  const std::size_t here = std::size_t(p);
  parent_[here] = kFree;
  round_[here] = 0;
  for (std::size_t k = 0; k < 8; ++k) {
    const int q = neighbour(p, k);
    std::uint8_t& parent = parent_[std::size_t(q)];
    if (parent == kFree || of_sink_[std::size_t(q)] != of_sink_[here]) continue;
    if (outwards(q, kGridBack[k], of_sink_[here]) != 0) enqueue(q);
    if (parent != kGridBack[k]) continue;
    orphans_.push_back(q);
    parent = kOrphan;
  }
}

void GridCut::cut() {
  start();
  while (grow()) {
    augment();
    adopt();
  }
}

}  // namespace ngs
