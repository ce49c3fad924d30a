#include "ngs/ops/optim/anderson.h"

#include <Eigen/Dense>

#include "ngs/core/check.h"

namespace ngs {
namespace {

std::vector<double> difference(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> d(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) d[i] = a[i] - b[i];
  return d;
}

double weighted_dot(const std::vector<double>& a, const std::vector<double>& b, const std::vector<double>& w) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += w[i] * a[i] * b[i];
  return sum;
}

constexpr double kRidge = 1e-10;  // of the diagonal: the differences of a converging sequence become linearly dependent

}  // namespace

std::vector<double> Anderson::next(const std::vector<double>& x, const std::vector<double>& f,
                                   const std::vector<double>& weight) {
  NGS_CHECK(x.size() == f.size() && x.size() == weight.size(), "Anderson: x, f and weight must have one size");
  if (!last_x_.empty()) {
    dx_.push_back(difference(x, last_x_));
    df_.push_back(difference(f, last_f_));
    if (dx_.size() > depth_) {
      dx_.erase(dx_.begin());
      df_.erase(df_.begin());
    }
  }
  last_x_ = x;
  last_f_ = f;
  std::vector<double> out(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) out[i] = x[i] + f[i];
  const auto k = Eigen::Index(df_.size());
  if (k == 0) return out;
  Eigen::MatrixXd gram(k, k);
  Eigen::VectorXd right(k);
  for (Eigen::Index i = 0; i < k; ++i) {
    right(i) = weighted_dot(df_[std::size_t(i)], f, weight);
    for (Eigen::Index j = 0; j <= i; ++j)
      gram(i, j) = gram(j, i) = weighted_dot(df_[std::size_t(i)], df_[std::size_t(j)], weight);
  }
  gram.diagonal() *= 1 + kRidge;
  const Eigen::VectorXd gamma = gram.ldlt().solve(right);
  if (!gamma.allFinite()) {
    reset();
    return out;
  }
  for (Eigen::Index j = 0; j < k; ++j)
    for (std::size_t i = 0; i < x.size(); ++i) out[i] -= gamma(j) * (dx_[std::size_t(j)][i] + df_[std::size_t(j)][i]);
  return out;
}

void Anderson::reset() {
  last_x_.clear();
  last_f_.clear();
  dx_.clear();
  df_.clear();
}

}  // namespace ngs
