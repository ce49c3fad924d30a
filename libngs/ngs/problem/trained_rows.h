#pragma once
// The Gaussians that a trainer changes. With a region, only its rows have gradients and moments. Without a region, all
// rows are trained in place.                                                                           paper.md §5.16
#include <memory>
#include <optional>
#include <vector>

#include "ngs/ops/optim/resident.h"
#include "ngs/ops/optim/rows.h"
#include "ngs/ops/splat/splat.h"
#include "ngs/problem/cloud_rows.h"

namespace ngs {

class TrainedRows {
 public:
  /// `region` [N] 1: trained; empty: all are trained. `frozen` [N] 1: only the label is trained; may be empty. `all`
  /// must outlive this object.
  TrainedRows(const Exec& exec, const std::vector<std::uint8_t>& region, const std::vector<std::uint8_t>& frozen,
              GaussianCloud& all)
      : all_(all) {
    wanted_.label_only = frozen;
    if (region.empty()) return;
    wanted_.gradient_row.assign(region.size(), -1);
    for (std::size_t i = 0; i < region.size(); ++i)
      if (region[i]) {
        wanted_.gradient_row[i] = std::int32_t(rows_.size());
        rows_.push_back(std::int64_t(i));
      }
    wanted_.rows = std::int64_t(rows_.size());
    part_ = gather_rows(exec, all, rows_);
    if (!rows_are_on_device(exec)) prepared_ = prepare_cloud(exec, all);
  }

  /// Adds all arrays of a step.
  void add_to(Resident& resident) {
    for (GaussianCloud* cloud : {&all_, &part_}) {
      for (const auto column : kTrainedColumns) resident.add(cloud->*column);
      resident.add(cloud->usable);
    }
    resident.add(rows_);
    resident.add(wanted_.gradient_row);
    resident.add(wanted_.label_only);
  }

  /// SH bands from 1 are not trained. Call before the first step.
  void keep_sh_rest() { wanted_.sh_rest = false; }

  const GradientRows& wanted() const { return wanted_; }
  std::size_t size() const { return is_part() ? rows_.size() : std::size_t(all_.size()); }
  std::size_t row(std::size_t r) const { return is_part() ? std::size_t(rows_[r]) : r; }
  /// Row of the gradients of a Gaussian's shape and colour; nullopt: they are not trained.
  std::optional<std::size_t> gradient_row(std::size_t gaussian) const {
    if (!wanted_.label_only.empty() && wanted_.label_only[gaussian]) return std::nullopt;
    if (!is_part()) return gaussian;
    return wanted_.gradient_row[gaussian] < 0 ? std::nullopt
                                              : std::optional(std::size_t(wanted_.gradient_row[gaussian]));
  }
  /// [size()] row() of all; null: all rows are trained.
  const std::int64_t* rows() const { return is_part() ? rows_.data() : nullptr; }
  /// The trained rows. write_back() copies them to the whole cloud; on a device, both must be resident.
  GaussianCloud& cloud() { return is_part() ? part_ : all_; }
  /// `changed` [size()] 0: the row's values are those of the last call; null: all rows may have changed.
  void write_back(const Exec& exec, const std::vector<std::uint8_t>* changed = nullptr) {
    if (!is_part()) return;
    if (changed == nullptr || rows_are_on_device(exec)) {
      for_each_row(exec, std::int64_t(rows_.size()), scatter());
      if (prepared_) update_prepared(exec, rows_, *prepared_);
      return;
    }
    std::vector<std::int64_t> rows;
    for (std::size_t r = 0; r < rows_.size(); ++r)
      if ((*changed)[r]) rows.push_back(rows_[r]);
    for_each_index(exec, std::int64_t(rows_.size()), [&, kernel = scatter()](std::int64_t r) {
      if ((*changed)[std::size_t(r)]) kernel(r);
    });
    if (prepared_) update_prepared(exec, rows, *prepared_);
  }
  /// `options` with the prepared data of the whole cloud.
  SplatOptions prepared(SplatOptions options) const {
    if (is_part()) options.prepared = prepared_;
    return options;
  }

 private:
  static constexpr std::vector<float> GaussianCloud::*kTrainedColumns[ScatterRows::kColumns] = {
      &GaussianCloud::position,      &GaussianCloud::rotation, &GaussianCloud::log_scale,
      &GaussianCloud::logit_opacity, &GaussianCloud::sh_dc,    &GaussianCloud::sh_rest};
  bool is_part() const { return !wanted_.gradient_row.empty(); }
  ScatterRows scatter() {
    ScatterRows kernel{rows_.data(), {}, {}, {}};
    for (std::size_t c = 0; c < ScatterRows::kColumns && !rows_.empty(); ++c) {
      const std::vector<float>& part = part_.*kTrainedColumns[c];
      const bool kept = !wanted_.sh_rest && kTrainedColumns[c] == &GaussianCloud::sh_rest;
      kernel.width[c] = kept ? 0 : int(part.size() / rows_.size());
      kernel.part[c] = part.data();
      kernel.all[c] = (all_.*kTrainedColumns[c]).data();
    }
    return kernel;
  }

  GaussianCloud& all_;
  GaussianCloud part_;              // of rows_
  std::vector<std::int64_t> rows_;  // increasing
  GradientRows wanted_;
  std::shared_ptr<PreparedCloud> prepared_;
};

}  // namespace ngs
