#pragma once
// What ops/neighbours/knn.cpp needs of FLANN, for a browser, which has none: the same search by KdTree.
#include <memory>

#include "ngs/ops/neighbours/kd_tree.h"

namespace flann {

template <class T>
struct ResultSet {
  virtual ~ResultSet() = default;
  virtual bool full() const = 0;
  virtual T worstDist() const = 0;
  virtual void addPoint(T dist2, std::size_t index) = 0;
};

template <class T>
struct Matrix {
  Matrix(T* data, std::size_t rows, std::size_t) : begin(data), end(data + 3 * rows) {}
  T *begin, *end;
};

template <class T>
struct L2_Simple {};

constexpr int FLANN_CHECKS_UNLIMITED = -1;
struct SearchParams {
  int checks;
  float slack;  // unused: bounds of KdTree are exact
};
struct KDTreeSingleIndexParams {};

template <class Distance>
class KDTreeSingleIndex {
 public:
  KDTreeSingleIndex(const Matrix<double>& points, KDTreeSingleIndexParams)
      : point_(points.begin, std::size_t(points.end - points.begin)) {}
  void buildIndex() { tree_ = std::make_unique<ngs::KdTree>(point_); }
  void findNeighbors(ResultSet<double>& result, const double* query, const SearchParams&) const {
    struct Adapted {
      ResultSet<double>& to;
      double worst() const { return to.worstDist(); }
      void add(double dist2, std::size_t index) { to.addPoint(dist2, index); }
    } adapted{result};
    tree_->search(adapted, query);
  }

 private:
  std::span<const double> point_;
  std::unique_ptr<ngs::KdTree> tree_;
};

}  // namespace flann
