#include "ngs/passes/joint/trained_labels.h"

#include "ngs/backend/for_each.h"
#include "ngs/passes/joint/label_start.h"
#include "ngs/stages/boundary/method_labels.h"

namespace ngs {

void TrainedLabels::start(const Problem& input, int steps) {
  gaussians_ = input.cloud.size(), objects_ = input.labels.size();
  const auto n = std::size_t(gaussians_);
  label_.resize(n * objects_), logit_.resize(rows_.size() * objects_), trainable_.resize(logit_.size());
  const auto log_odds = [&](std::size_t i, std::size_t k) {
    const double prob = double(is_fixed(input, i) ? input.labels[k].label[i] : input.labels[k].prob[i]);
    return float(start_log_odds(prob, steps));
  };
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t k = 0; k < objects_; ++k) label_[i * objects_ + k] = sigmoid(log_odds(i, k));
  for (std::size_t r = 0; r < rows_.size(); ++r)
    for (std::size_t k = 0; k < objects_; ++k) {
      const std::size_t i = rows_.row(r);
      trainable_[r * objects_ + k] = input.labels[k].views[i] > 0.f && !is_fixed(input, i);
      logit_[r * objects_ + k] = log_odds(i, k);
    }
}

void TrainedLabels::to_logits(std::vector<float>& grad) const {
  for (std::size_t i = 0; i < logit_.size(); ++i) grad[i] = trainable_[i] ? grad[i] * sigmoid_slope(logit_[i]) : 0.f;
}

void TrainedLabels::step(const Exec& exec, double rate, std::int64_t t, const std::vector<float>& grad) {
  adam_step(exec, {.lr = rate}, t, {"label", logit_, grad}, moments_);
}

void TrainedLabels::put_back(const Exec& exec) {
  for_each_index(exec, std::int64_t(rows_.size()), [&](std::int64_t row) {
    const auto r = std::size_t(row);
    for (std::size_t k = 0; k < objects_; ++k) label_[rows_.row(r) * objects_ + k] = sigmoid(logit_[r * objects_ + k]);
  });
}

/// The first trained row beyond the page of label columns in which `row` of them lies.
std::size_t TrainedLabels::end_of_page(std::size_t row) const {
  const std::size_t page = rows_.row(row) / LabelColumn::kPageRows;
  while (row < rows_.size() && rows_.row(row) / LabelColumn::kPageRows == page) ++row;
  return row;
}

void TrainedLabels::write(std::vector<LabelColumns>& columns) const {
  for (std::size_t begin = 0, end = 0; begin < rows_.size(); begin = end) {
    end = end_of_page(begin);
    for (std::size_t k = 0; k < objects_; ++k) {
      for (std::size_t r = begin; r < end; ++r) {
        const std::size_t i = rows_.row(r);
        if (trainable_[r * objects_ + k]) columns[k].label[i] = columns[k].prob[i] = label_[i * objects_ + k];
      }
      // Most pages are the same, and have no cell that is 0: with many objects these are the largest part of a result.
      columns[k].label.share(columns[k].prob, rows_.row(begin));
    }
  }
}

}  // namespace ngs
