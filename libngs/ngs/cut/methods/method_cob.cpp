#include "ngs/cut/methods/method_cob.h"

#include <algorithm>
#include <numeric>

#include "ngs/backend/for_each.h"
#include "ngs/core/rng.h"
#include "ngs/math/stable.h"
#include "ngs/problem/view_list.h"

namespace ngs {
namespace {

constexpr double kLabelRate = 0.1;  // Adam rate of the label logits
constexpr double kExtract = 0.9;    // label 1 if the sigmoid exceeds this

constexpr int kLabelOnlyPhases = 5;  // 10 V iterations, the published code's default without texture phases

}  // namespace

CobTrainer::CobTrainer(const CobOptions& options, const Problem& input)
    : options_(options),
      input_(input),
      extent_(scene_extent(cameras_of(input.scene, input.views))),
      objects_(int(input.scene.objects.size())),
      cloud_(input.cloud),
      evidence_(input.cloud.size(), objects_),
      pass_(input.splat) {
  source_row_.resize(std::size_t(cloud_.size()));
  std::iota(source_row_.begin(), source_row_.end(), std::int64_t(0));
  logit_.assign(source_row_.size() * std::size_t(objects_), 0.f);
}

void CobTrainer::mask_phase(const Exec& exec, Monitor& monitor) {
  const auto timed = monitor.scope("mask phase");
  evidence_ = Evidence(cloud_.size(), objects_);
  mask_views_ = 0;
  for (int pass = 0; pass < 2; ++pass)
    for (const std::size_t view : shuffled(input_.views, input_.seed, std::uint64_t(epochs_++))) {
      if (monitor.stop_requested()) break;
      const ViewMasks masks = input_.load_masks(view);
      if (!masks.available) continue;
      const ViewSums one = view_sums(exec, cloud_, {input_.scene.views[view].camera, masks}, input_.splat);
      label_step(exec, one);
      if (pass > 0) continue;  // the second pass has the same evidence
      evidence_.add(one);
      ++mask_views_;
    }
  columns_ = label_gaussians(input_.rule, evidence_);
}

/// The linear loss -Σ G M + λ Σ (1 - G) M has the constant gradient λ (W - W1) - W1 in m = sigmoid(logit).
void CobTrainer::label_step(const Exec& exec, const ViewSums& view) {
  std::vector<float> gradient(logit_.size());
  for_each_index(exec, std::ssize(view.row), [&](std::int64_t index) {
    const auto v = std::size_t(index);
    for (std::size_t k = 0; k < std::size_t(objects_); ++k) {
      const std::size_t cell = view.row[v] * std::size_t(objects_) + k;
      const double inside = view.object_weight(v, k), outside = view.weight(v) - inside;
      const double m = sigmoid(double(logit_[cell]));
      gradient[cell] = float((options_.lambda * outside - inside) * m * (1 - m));
    }
  });
  adam_step(exec, {.lr = kLabelRate}, ++label_steps_, {"label", logit_, gradient}, label_moments_);
}

std::vector<double> CobTrainer::certainty() const {
  std::vector<double> mean(std::size_t(cloud_.size()), 1.0);
  const double all = double(mask_views_);
  for (std::size_t i = 0; i < mean.size(); ++i) {
    const double visible = double(evidence_.views[i]);
    if (visible == 0) continue;
    for (std::size_t k = 0; k < std::size_t(objects_); ++k) {
      const double sum = double(evidence_.contrast_sum(i, k)) * 0x1p-32;
      const double r = options_.divisor == CobDivisor::kVisible ? sum / visible : (sum + all - visible) / all;
      mean[i] = std::min(mean[i], r);
    }
  }
  return mean;
}

void CobTrainer::split(const Exec& exec) {
  const std::vector<double> certain = certainty();
  std::vector<CloudRow> rows, children;
  for (std::int64_t i = 0; i < cloud_.size(); ++i) {
    const bool chosen = certain[std::size_t(i)] < options_.ambiguity && !keeps_label(std::size_t(i)) &&
                        largest_scale(cloud_, i) > options_.split_scale * extent_;
    if (!chosen)
      rows.push_back({i, RowOrigin::kKept});
    else {
      children.push_back({i, RowOrigin::kChild0});
      children.push_back({i, RowOrigin::kChild1});
    }
  }
  split_ += std::int64_t(children.size()) / 2;
  rows.insert(rows.end(), children.begin(), children.end());
  apply(exec, rows);
}

void CobTrainer::prune(const Exec& exec) {
  const std::vector<double> certain = certainty();
  std::vector<CloudRow> rows;
  for (std::int64_t i = 0; i < cloud_.size(); ++i)
    if (!(certain[std::size_t(i)] < options_.ambiguity) || keeps_label(std::size_t(i)))
      rows.push_back({i, RowOrigin::kKept});
  pruned_ += cloud_.size() - std::int64_t(rows.size());
  apply(exec, rows);
}

/// Children of a split start with logit 0 and zero moments.
void CobTrainer::apply(const Exec& exec, const std::vector<CloudRow>& rows) {
  edit_rows(exec, rows, rng_bits(input_.seed, RngStream::kSplit, std::uint64_t(edits_++)), cloud_);
  for (std::size_t g = 0; g < kGaussianGroups; ++g) edit_moments(rows, group_width(cloud_, g), moments_[g]);
  edit_moments(rows, objects_, label_moments_);
  edit_column(exec, rows, objects_, logit_);
  edit_labels(exec, rows, columns_);
  std::vector<std::int64_t> source(rows.size());
  for (std::size_t r = 0; r < rows.size(); ++r) {
    source[r] = source_row_[std::size_t(rows[r].source)];
    if (rows[r].origin != RowOrigin::kKept) std::fill_n(logit_.begin() + std::ptrdiff_t(r) * objects_, objects_, 0.f);
  }
  source_row_ = std::move(source);
}

void CobTrainer::texture_phase(const Exec& exec, Monitor& monitor, const ColourTerm& colour_term) {
  const auto timed = monitor.scope("texture phase");
  for (int pass = 0; pass < 2; ++pass)
    for (const std::size_t view : shuffled(input_.views, input_.seed, std::uint64_t(epochs_++))) {
      if (monitor.stop_requested()) return;
      const ImageF photo = input_.load_photo ? input_.load_photo(view) : ImageF();
      if (!photo.empty()) texture_step(exec, view, photo, colour_term);
    }
  if (texture_steps_ == 0)
    throw Error(ErrorCode::kInconsistent,
                "cob: no training view with a photo, expected at least one for the texture phases",
                "give the photos to ngs-scene import, or train labels only: --cob-rounds 0");
}

void CobTrainer::texture_step(const Exec& exec, std::size_t view, const ImageF& photo, const ColourTerm& colour_term) {
  RenderRequest request;
  request.background = input_.background;
  const RenderedView& rendered = pass_.forward(exec, cloud_, input_.scene.views[view].camera, request);
  last_photometric_ = photometric_.evaluate(exec, {}, {rendered.colour, photo}, &image_gradient_.colour).total;
  if (texture_steps_ == 0) first_photometric_ = last_photometric_;
  pass_.backward(exec, image_gradient_, gradients_);
  if (colour_term) colour_term(exec, cloud_, logit_, gradients_.sh_dc);
  ++texture_steps_;
  const CobOptions& o = options_;
  const GroupRates rates{o.position_lr * extent_, o.rotation_lr, o.scale_lr, o.opacity_lr, o.dc_lr, o.rest_lr};
  step_gaussians(exec, {texture_steps_, rates}, gradients_, cloud_, moments_);
}

Solution CobTrainer::result(Monitor& monitor) {
  Solution out;
  out.labels = columns_;
  for (int k = 0; k < objects_; ++k) {
    LabelColumns& c = out.labels[std::size_t(k)];
    for (std::size_t i = 0; i < c.prob.size(); ++i) {
      if (c.views[i] == 0) continue;
      c.prob[i] = float(sigmoid(double(logit_[i * std::size_t(objects_) + std::size_t(k)])));
      c.label[i] = float(double(c.prob[i]) > kExtract);
    }
    const double count = labelled_count(c);
    out.figures["object_gaussians"] += count;
    if (count == 0)
      monitor.warn("cob: no label of " + input_.scene.objects[std::size_t(k)].name +
                   " reached the extraction threshold");
  }
  restore_fixed(input_, source_row_, out.labels);
  out.cloud = std::make_shared<const GaussianCloud>(cloud_);
  out.source_row = source_row_;
  out.figures["split"] = double(split_);
  out.figures["pruned"] = double(pruned_);
  out.figures["label_steps"] = double(label_steps_);
  out.figures["texture_steps"] = double(texture_steps_);
  out.figures["first_photometric_loss"] = first_photometric_;
  out.figures["last_photometric_loss"] = last_photometric_;
  out.converged = !monitor.stop_requested();
  return out;
}

Solution run_cob_schedule(const Exec& exec, Monitor& monitor, const CobOptions& options, const Problem& input,
                          const ColourTerm& colour_term) {
  CobTrainer trainer(options, input);
  for (int phase = 0; phase < (options.rounds > 0 ? 1 : kLabelOnlyPhases); ++phase) trainer.mask_phase(exec, monitor);
  for (int round = 0; round < options.rounds && !monitor.stop_requested(); ++round) {
    trainer.split(exec);
    trainer.texture_phase(exec, monitor, colour_term);
    trainer.mask_phase(exec, monitor);
    monitor.progress(round + 1, options.rounds);
  }
  if (options.rounds > 0 && !monitor.stop_requested()) trainer.prune(exec);
  return trainer.result(monitor);
}

Solution run_cob(const Exec& exec, Monitor& monitor, const CobOptions& options, const Problem& input) {
  return run_cob_schedule(exec, monitor, options, input, nullptr);
}

}  // namespace ngs
