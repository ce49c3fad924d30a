#include "ngs/passes/joint/resident_steps.h"

#include <bit>

#include "ngs/core/error.h"
#include "ngs/ops/optim/adam_kernels.h"

namespace ngs {
namespace {

std::vector<JointBlock> blocks_of(const ResidentModel& m) {
  static_assert(kJointLabel == 0 && kJointPosition == 1 && int(kJointRest) == int(kGaussianGroups),
                "columns are the labels, then the groups");
  std::vector<JointBlock> blocks;
  const auto add = [&](const char* name, std::vector<float>& value, AdamMoments& moments, double rate) {
    blocks.push_back({.name = name, .value = value, .moments = &moments, .rate = rate});
  };
  add("label", m.logit, m.label_moments, m.options.rate_label);
  for (std::size_t g = 0; g < kGaussianGroups; ++g)
    add(kGroupColumns[g].name, m.cloud.*kGroupColumns[g].value, m.moments[g], m.rates[g]);
  if (m.field != nullptr)
    for (JointBlock& block : m.field->blocks()) blocks.push_back(std::move(block));
  return blocks;
}

JointTerms terms_of(const ResidentModel& m) {
  const JointOptions& o = m.options;
  const JointSwitches& e = m.effects;
  const double width = m.field != nullptr ? m.field->width() : 1;
  return {.photometric = e.photometric,
          .align = e.align,
          .density = e.density,
          .mask = e.mask,
          .cont = e.cont && m.colour_graph.queries() > 0,
          .smooth = e.smooth,
          .label_moves_geometry = e.mask_geometry,
          .excess_variance = o.excess_variance,
          .pixel_windows = m.sample.window == WindowCentre::kPixel,
          .whole_image = m.sample.whole_image,
          .photometric_weight = o.photometric_weight,
          .lambda_mask = o.lambda_mask,
          .lambda_cont = o.lambda_cont,
          .lambda_smooth = o.lambda_smooth,
          .align_options = {o.weight_opacity, e.variance ? o.weight_variance : 0.0},
          .mask_form = o.mask_loss,
          .smooth_points = o.smooth_points,
          .smooth_scale = {o.smooth_step * width, width}};
}

}  // namespace

ResidentSteps::ResidentSteps(const DeviceJointOps& ops, const ResidentModel& m, Views views)
    : blocks_(blocks_of(m)), views_count_(std::int64_t(m.input.views.size())), views_(std::move(views)) {
  const SampleOptions& s = m.sample;
  joint_ = ops.start({.terms = terms_of(m),
                      .blocks = blocks_,
                      .initial = m.input.cloud,
                      .sh_degree = std::min(m.cloud.sh_degree, m.splat.max_sh_degree),
                      .trainable = m.trainable,
                      .frozen = m.frozen,
                      .objects = int(m.input.labels.size()),
                      .boundary = m.boundary.row,
                      .colour_graph = &m.colour_graph,
                      .field = m.field != nullptr ? std::optional(m.field->layout()) : std::nullopt,
                      .shape = {s.rows, s.cols, s.nodes},
                      .rays = {s.depth_samples, s.depth_span, s.depth_epsilon, 0},
                      .bbox_pad_px = s.bbox_pad_px,
                      .splat = m.splat,
                      .initial_splat = m.input.splat,
                      .background = m.input.background,
                      .seed = m.input.seed,
                      .rate_decay = m.options.rate_decay,
                      .views = views_count_});
}

void ResidentSteps::launch(std::int64_t step) {
  const std::size_t n = views_.at(step);
  const JointView view = views_.view(n);
  if (step >= views_count_) return joint_->step(view, JointQueries::kCurrent, {});
  if (!views_.given) return joint_->step(view, JointQueries::kInitial, {});
  const FieldRays given = views_.given(n);
  joint_->step(view, JointQueries::kGiven, {&given.rays, &given.graph});
}

void ResidentSteps::step(std::int64_t planned_steps) {
  if (!resident_) joint_->upload(asked_, planned_steps), begun_ = asked_;
  if (resident_ && planned_steps != planned_) settle(), joint_->plan(planned_steps);
  resident_ = true, planned_ = planned_steps;
  launch(asked_++);
  const auto since = std::uint64_t(asked_ - begun_);
  if (since % kSettleEvery == 0 || std::has_single_bit(since)) settle();
}

void ResidentSteps::settle() {
  for (;;) {
    const JointStatus status = joint_->status();
    if (status.bad_block >= 0)
      with_context(views_.context(status.done), [&] {
        refuse_step(blocks_[std::size_t(status.bad_block)].name, status.bad_index, double(status.bad_value),
                        double(adam_limit<float>()));
      });
    if (!status.full) return;
    joint_->resume(status.pairs + status.pairs / 2);
    for (std::int64_t again = status.done; again < asked_; ++again) launch(again);
  }
}

JointLosses ResidentSteps::losses() {
  settle();
  return joint_->losses();
}

void ResidentSteps::download() {
  if (!resident_) return;
  settle();
  joint_->download();
}

}  // namespace ngs
