#pragma once
// The Gaussians that a trainer changes. With a region, only its rows have gradients and moments. Without a region, all
// rows are trained in place.                                                                           paper.md §5.16
#include <memory>
#include <optional>
#include <vector>

#include "ngs/ops/splat/splat.h"
#include "ngs/problem/cloud_rows.h"

namespace ngs {

class TrainedRows {
 public:
  /// `region` [N] 1: trained; empty: all are trained. `frozen` [N] 1: only the label is trained; may be empty. `all`
  /// must outlive this object.
  TrainedRows(const Exec& exec, const std::vector<std::uint8_t>& region, const std::vector<std::uint8_t>& frozen,
              GaussianCloud& all)
      : exec_(exec), all_(all) {
    wanted_.label_alone = frozen;
    if (region.empty()) return;
    wanted_.place.assign(region.size(), -1);
    for (std::size_t i = 0; i < region.size(); ++i)
      if (region[i]) wanted_.place[i] = std::int32_t(rows_.size()), rows_.push_back(std::int64_t(i));
    wanted_.rows = std::int64_t(rows_.size());
    part_ = gather_rows(exec, all, rows_);
    prepared_ = prepare_cloud(exec, all);
  }

  const GradientRows& wanted() const { return wanted_; }
  std::size_t size() const { return is_part() ? rows_.size() : std::size_t(all_.size()); }
  std::size_t row(std::size_t r) const { return is_part() ? std::size_t(rows_[r]) : r; }
  /// Row of the gradients of a Gaussian's shape and colour; nullopt: they are not trained.
  std::optional<std::size_t> place(std::size_t gaussian) const {
    if (!wanted_.label_alone.empty() && wanted_.label_alone[gaussian]) return std::nullopt;
    if (!is_part()) return gaussian;
    return wanted_.place[gaussian] < 0 ? std::nullopt : std::optional(std::size_t(wanted_.place[gaussian]));
  }
  /// The trained rows. write_back() copies them to the whole cloud.
  GaussianCloud& cloud() { return is_part() ? part_ : all_; }
  void write_back() {
    if (!is_part()) return;
    scatter_rows(exec_, part_, rows_, all_);
    if (prepared_) update_prepared(exec_, rows_, *prepared_);
  }
  /// `options` with the prepared data of the whole cloud.
  SplatOptions prepared(SplatOptions options) const {
    if (is_part()) options.prepared = prepared_;
    return options;
  }

 private:
  bool is_part() const { return !wanted_.place.empty(); }

  Exec exec_;
  GaussianCloud& all_;
  GaussianCloud part_;              // of rows_
  std::vector<std::int64_t> rows_;  // increasing
  GradientRows wanted_;
  std::shared_ptr<PreparedCloud> prepared_;
};

}  // namespace ngs
