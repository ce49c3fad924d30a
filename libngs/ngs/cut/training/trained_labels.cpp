#include "ngs/cut/training/trained_labels.h"

#include <algorithm>
#include <numeric>

#include "ngs/cut/evidence/method_labels.h"
#include "ngs/problem/region.h"

namespace ngs {
namespace {

/// The objects whose region contains a row; all objects if none does, or without a region.
std::vector<std::size_t> objects_of(const Problem& input, std::size_t row) {
  std::vector<std::size_t> own;
  for (std::size_t k = 0; k < input.labels.size() && !input.region.empty(); ++k)
    if (in_region(input.labels[k], row)) own.push_back(k);
  if (!own.empty()) return own;
  own.resize(input.labels.size());
  std::iota(own.begin(), own.end(), std::size_t(0));
  return own;
}

}  // namespace

void TrainedLabels::start(const Problem& input, int steps) {
  gaussians_ = input.cloud.size();
  objects_ = input.labels.size();
  const auto n = std::size_t(gaussians_);
  const auto log_odds = [&](std::size_t i, std::size_t k) {
    const double prob = double(is_fixed(input, i) ? input.labels[k].label[i] : input.labels[k].prob[i]);
    return float(start_log_odds(prob, steps));
  };
  const auto is_trained = [&](std::size_t i, std::size_t k) {
    return input.labels[k].views[i] > 0.f && !is_fixed(input, i);
  };
  label_.resize(n * objects_);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t k = 0; k < objects_; ++k) label_[i * objects_ + k] = sigmoid(log_odds(i, k));
  begin_.assign(1, 0);
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    const std::size_t i = rows_.row(r);
    for (const std::size_t k : objects_of(input, i))
      if (is_trained(i, k)) {
        object_.push_back(std::uint32_t(k));
        logit_.push_back(log_odds(i, k));
      }
    begin_.push_back(object_.size());
  }
  grad_.resize(logit_.size());
}

AdamGroup TrainedLabels::group(const Exec& exec, double rate, const std::vector<float>& grad) {
  if (!grad_.empty())
    for_each_row(exec, std::int64_t(rows_.size()), LabelCellGradients{cells(), grad.data(), grad_.data()});
  return {{.lr = rate}, {"label", logit_, grad_}, moments_};
}

void TrainedLabels::write_back(const Exec& exec) {
  if (!logit_.empty())
    for_each_row(exec, std::int64_t(rows_.size()), LabelCellValues{cells(), rows_.rows(), label_.data()});
}

void TrainedLabels::add_to(Resident& resident) {
  moments_.m.resize(logit_.size());
  moments_.v.resize(logit_.size());
  for (std::vector<float>* values : {&label_, &logit_, &grad_, &moments_.m, &moments_.v}) resident.add(*values);
  resident.add(begin_);
  resident.add(object_);
}

/// The first trained row after the page of label columns that contains trained row `row`.
std::size_t TrainedLabels::end_of_page(std::size_t row) const {
  const std::size_t page = rows_.row(row) / LabelColumn::kPageRows;
  while (row < rows_.size() && rows_.row(row) / LabelColumn::kPageRows == page) ++row;
  return row;
}

void TrainedLabels::write(std::vector<LabelColumns>& columns) const {
  std::vector<std::uint8_t> written(objects_);
  for (std::size_t begin = 0, end = 0; begin < rows_.size(); begin = end) {
    end = end_of_page(begin);
    std::ranges::fill(written, std::uint8_t(0));
    for (std::size_t r = begin; r < end; ++r)
      for (std::size_t c = begin_[r], i = rows_.row(r); c < begin_[r + 1]; ++c) {
        const std::size_t k = object_[c];
        columns[k].label[i] = columns[k].prob[i] = label_[i * objects_ + k];
        written[k] = 1;
      }
    // label and prob are equal in most pages, so they share them: with many objects pages are most of a result.
    for (std::size_t k = 0; k < objects_; ++k)
      if (written[k]) columns[k].label.share(columns[k].prob, rows_.row(begin));
  }
}

}  // namespace ngs
