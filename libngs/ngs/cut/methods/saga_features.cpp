#include "ngs/cut/methods/saga_features.h"

#include <algorithm>

namespace ngs {
namespace {

constexpr double kShortest = 1e-3;  // least length of a rendered feature whose direction is used

struct PairCounts {
  double same = 0, different = 0;
};

PairCounts count_pairs(std::span<const int> id, const std::vector<double>& length) {
  std::vector<double> of(std::size_t(*std::max_element(id.begin(), id.end())) + 1, 0.0);
  double all = 0, squares = 0;
  PairCounts pairs;
  for (std::size_t i = 0; i < id.size(); ++i)
    if (length[i] >= kShortest) ++of[std::size_t(id[i])], ++all;
  for (std::size_t k = 0; k < of.size(); ++k) {
    squares += of[k] * of[k];
    if (k > 0) pairs.same += of[k] * (of[k] - 1) / 2;
  }
  pairs.different = (all * all - squares) / 2;
  return pairs;
}

}  // namespace

double contrastive_loss(const Exec& exec, int dims, std::span<const float> features, std::span<const int> id,
                        std::vector<float>& grad) {
  const auto d = std::size_t(dims), n = id.size();
  grad.assign(features.size(), 0.f);
  if (n == 0) return 0;
  std::vector<double> unit(features.size(), 0.0), length(n), row_loss(n);
  double mean_length = 0;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t c = 0; c < d; ++c) length[i] += double(features[i * d + c]) * double(features[i * d + c]);
    length[i] = std::sqrt(length[i]);
    mean_length += length[i] / double(n);
    if (length[i] > 0)
      for (std::size_t c = 0; c < d; ++c) unit[i * d + c] = double(features[i * d + c]) / length[i];
  }
  const PairCounts pairs = count_pairs(id, length);
  const double same = pairs.same > 0 ? 1 / pairs.same : 0, different = pairs.different > 0 ? 1 / pairs.different : 0;
  for_each_index(exec, std::int64_t(n), [&](std::int64_t row) {
    const auto i = std::size_t(row);
    std::vector<double> g(d, 0.0);
    const double* a = &unit[i * d];
    for (std::size_t j = 0; j < n && length[i] >= kShortest; ++j) {
      if (j == i || length[j] < kShortest || (id[i] == 0 && id[j] == 0)) continue;
      const double* b = &unit[j * d];
      double cosine = 0;
      for (std::size_t c = 0; c < d; ++c) cosine += a[c] * b[c];
      const double factor = id[i] == id[j] ? -same : cosine > 0 ? different : 0.0;
      row_loss[i] += 0.5 * factor * cosine;  // every pair is visited from both sides
      for (std::size_t c = 0; c < d; ++c) g[c] += factor * b[c];
    }
    double along = 0;
    for (std::size_t c = 0; c < d; ++c) along += g[c] * a[c];
    const double pull = -2 * (1 - mean_length) / double(n);
    for (std::size_t c = 0; c < d && length[i] > 0; ++c)
      grad[i * d + c] = float((g[c] - along * a[c]) / length[i] + pull * a[c]);
  });
  double loss = (1 - mean_length) * (1 - mean_length);
  for (const double l : row_loss) loss += l;
  return loss;
}

}  // namespace ngs
