#pragma once
// The joint step on a device: DeviceJoint on a Grid. What step_view of passes/joint/joint_stage.cpp does with the ops, in the same
// order, on memory that stays.                                                        Eq. (20)
#include <optional>

#include "ngs/math/sh.h"
#include "ngs/ops/device/joint_adam_grid.h"
#include "ngs/ops/device/joint_field_grid.h"
#include "ngs/ops/device/joint_images_grid.h"
#include "ngs/ops/losses/loss_cont_kernels.h"
#include "ngs/ops/device/splat_schedule.h"

namespace ngs {

struct LabelValues {
  static constexpr const char* kName = "label_values";
  const float* logit;
  float* label;
  NGS_HD void operator()(std::int64_t i) const { label[i] = sigmoid(logit[i]); }
};

struct LogitGradients {
  static constexpr const char* kName = "logit_gradients";
  const std::uint8_t* trainable;
  const float* logit;
  float* grad;  // of the labels, then of the logits
  NGS_HD void operator()(std::int64_t i) const { grad[i] = trainable[i] ? grad[i] * sigmoid_slope(logit[i]) : 0.f; }
};

struct BoundaryColours {
  static constexpr const char* kName = "boundary_colours";
  const std::uint32_t* row;
  const float* sh_dc;
  float* colour;  // [B, 3]
  NGS_HD void operator()(std::int64_t i) const {
    colour[i] = float(0.5 + kShC0 * double(sh_dc[std::int64_t(row[i / 3]) * 3 + i % 3]));
  }
};

/// Rows of the boundary are different ones, so index i owns what it adds to.
struct AddColourGradients {
  static constexpr const char* kName = "add_colour_gradients";
  const std::uint32_t* row;
  const float* grad;           // [B, 3]
  const std::uint8_t* frozen;  // [N], null: none
  float* sh_dc;
  NGS_HD void operator()(std::int64_t i) const {
    if (!frozen || !frozen[row[i / 3]]) sh_dc[std::int64_t(row[i / 3]) * 3 + i % 3] += float(kShC0 * double(grad[i]));
  }
};

template <class Grid>
class GridJoint final : public DeviceJoint {
  using Floats = DeviceBuffer<Grid, float>;
  using View = ViewOnGrid<Grid>;

 public:
  GridJoint(Grid& grid, const JointProblem& p, DeviceSums device_sums)
      : grid_(grid),
        p_(p),
        device_sums_(device_sums),
        n_(p.initial.size()),
        parameters_(grid, p.blocks, p.rate_decay),
        usable_(grid, p.initial.usable),
        trainable_(grid, p.trainable),
        frozen_(grid, p.frozen),
        boundary_row_(grid, p.boundary.data(), std::int64_t(p.boundary.size())),
        sums_(grid, kJointSums),
        most_pairs_(grid, 1),
        views_(std::size_t(p.views)) {
    most_pairs_.zero(), sums_.zero();
    if (p.field) field_.emplace(grid, *p.field, device_sums);
    if (p.terms.cont) {
      const KnnGraph& g = *p.colour_graph;
      cont_.neighbours = g.neighbours, cont_.points = g.points, cont_.queries = g.queries();
      cont_.index = {grid, g.index}, cont_.row_begin = {grid, g.row_begin}, cont_.edge = {grid, g.edge};
    }
  }

  void upload(std::int64_t done, std::int64_t steps) override { parameters_.upload(done, steps); }
  void download() override { parameters_.download(); }
  void plan(std::int64_t steps) override {
    JointClock clock = parameters_.clock();
    clock.steps = steps;
    parameters_.set_clock(clock);
  }

  void step(const JointView& view, JointQueries queries, const JointRays& given) override {
    std::optional<View> passing;
    View& at = resident(view, passing);
    last_ = {at.region, at.photo.size() > 0 ? at.pixels() : 0, at.known};
    if (queries == JointQueries::kCurrent && !passing)
      grid_.replay(at.later, [&] { run(at, view.camera, queries, given); });
    else
      run(at, view.camera, queries, given);
    if (queries == JointQueries::kCurrent) initial_.reset();
  }

  JointStatus status() override {
    const JointClock clock = parameters_.clock();
    JointStatus status{.done = clock.done, .pairs = clock.pairs, .full = clock.halt == JointHalt::kFull};
    if (clock.halt != JointHalt::kGradient) return status;
    const std::size_t block = parameters_.block_of(clock.bad_index);
    status.bad_block = std::int64_t(block), status.bad_index = clock.bad_index - parameters_.begin(block);
    status.bad_value = clock.bad_value;
    return status;
  }

  void resume(std::int64_t pairs) override {
    pair_capacity_ = pairs;
    for (const std::unique_ptr<View>& view : views_)
      if (view) view->later = {};  // what is recorded has the old capacity
    JointClock clock = parameters_.clock();
    clock.halt = JointHalt::kNone;
    parameters_.set_clock(clock);
  }

  JointLosses losses() override {
    std::vector<double> s;
    sums_.to(s);
    const JointTerms& t = p_.terms;
    JointLosses out;
    if (t.photometric && last_.photo_pixels > 0) {
      const PhotometricFactors f(last_.region, last_.photo_pixels);
      const double dssim = PhotometricOptions{}.dssim_weight;
      out.photometric = f.share * ((1 - dssim) * s[kSumL1] * f.norm + dssim * (1 - s[kSumSsim] * f.norm));
    }
    if (t.align && s[kSumActive] > 0)
      out.align = (s[kSumAlignColour] + t.align_options.weight_alpha * s[kSumAlignAlpha] +
                   t.align_options.weight_variance * s[kSumAlignVariance]) / s[kSumActive];
    if (t.mask && last_.known > 0) out.mask = s[kSumMask] / double(last_.known);
    if (t.cont) out.cont = s[kSumCont] / double(p_.boundary.size());
    if (t.smooth && s[kSumSmoothPoints] > 0)
      out.smooth = smoothness_factor(t.smooth_scale, std::int64_t(s[kSumSmoothPoints])) * s[kSumSmooth];
    return out;
  }

 private:
  /// Views stay while half of the memory that is left has room for them; else their images come with every step.
  View& resident(const JointView& view, std::optional<View>& passing) {
    std::unique_ptr<View>& kept = views_[view.number];
    if (kept) return *kept;
    const JointImages images = view.images();
    if (View::bytes(images) > grid_.bytes_to_spare() / 2) return passing.emplace(grid_, view.camera, images);
    kept = std::make_unique<View>(grid_, view.camera, images);
    return *kept;
  }

  PairRoom room() const { return {pair_capacity_, most_pairs_.data()}; }
  CloudView<float> cloud() const {
    const auto value = [&](JointColumn c) -> const float* { return parameters_.value(c); };
    return {n_, value(kJointPosition), value(kJointRotation), value(kJointScale), value(kJointOpacity), value(kJointDc),
            value(kJointRest), p_.sh_degree, p_.initial.rest_count(), usable_.data(), nullptr};
  }
  Floats boundary_of(const float* position) const {
    Floats out(grid_, boundary_row_.size() * 3);
    grid_.each(boundary_row_.size(), GatherPositions{boundary_row_.data(), position, out.data()});
    return out;
  }
  Rows<const float, 3> rows(const Floats& positions) const { return {positions.data(), boundary_row_.size()}; }

  void run(const View& view, const Camera& camera, JointQueries queries, const JointRays& given) {
    const JointTerms& t = p_.terms;
    const PairRoom room = this->room();
    const bool with_colour = t.photometric || t.align, with_mask = t.mask && view.known > 0;
    sums_.zero();
    parameters_.clear_gradients_from(kJointColumns);
    const Floats label(grid_, n_ * p_.objects);
    grid_.each(n_ * p_.objects, LabelValues{parameters_.value(kJointLabel), label.data()});
    const ChannelPlan<float> plan{with_colour, field_.has_value(), {label.data(), n_, p_.objects}};
    GridSplat<Grid> splat(grid_, camera, p_.splat, cloud(), plan, p_.background, &room);
    RenderedOnGrid<Grid> rendered(grid_, view.pixels(), with_colour, p_.objects, plan.depth, true);
    splat.forward(rendered.template planes<float>(plan));
    RenderedOnGrid<Grid> grad(grid_, view.pixels(), with_colour, with_mask ? p_.objects : 0, false, t.align);
    grad.alpha.zero();
    if (t.photometric && view.photo.size() > 0)
      photometric_term(grid_, view, t.photometric_weight, rendered, grad, sums_.data());
    else
      grad.colour.zero();
    const Floats weights = field_ ? field_terms(view, camera, queries, given, rendered, grad) : Floats();
    if (with_mask) mask_term(grid_, view, t, p_.objects, rendered, weights.data(), grad, sums_.data());
    std::vector<std::uint8_t> moves(std::size_t(plan.count()), 1);
    std::fill_n(moves.begin() + (with_colour ? 3 : 0), p_.objects, std::uint8_t(t.label_moves_geometry));
    splat.backward(grad.template planes<const float>(plan), moves,
                   {parameters_.wanted(kJointPosition), parameters_.wanted(kJointRotation), parameters_.wanted(kJointScale),
                    parameters_.wanted(kJointOpacity), parameters_.wanted(kJointDc), parameters_.wanted(kJointRest),
                    parameters_.wanted(kJointLabel), nullptr, nullptr, frozen_.data()},
                   device_sums_);
    if (float* logit_grad = parameters_.wanted(kJointLabel))
      grid_.each(n_ * p_.objects, LogitGradients{trainable_.data(), parameters_.value(kJointLabel), logit_grad});
    if (t.cont) continuity();
    parameters_.step(room);
  }

  /// Returns the weights of the pixels; empty: 1.
  Floats field_terms(const View& view, const Camera& camera, JointQueries queries, const JointRays& given,
                     const RenderedOnGrid<Grid>& rendered, RenderedOnGrid<Grid>& grad) {
    const JointTerms& t = p_.terms;
    const RayCamera ray = ray_camera(camera);
    const DepthPlanes map{rendered.depth.data(), rendered.alpha.data(), view.width_px, view.height_px};
    const Floats boundary = boundary_of(parameters_.value(kJointPosition));
    const RaysOnGrid<Grid> rays = queries == JointQueries::kGiven     ? given_rays(grid_, given)
                                  : queries == JointQueries::kInitial ? initial_rays(view, camera, ray)
                                  : sampled_rays(grid_, p_, ray, rows(boundary), t.pixel_windows ? map : DepthPlanes{});
    if (rays.rays == 0) return {};
    grid_.each(rays.rays, RayOfViewOnSurface{{ray, {}, map, rays.near.data(), rays.far.data(), rays.on_surface.data()},
                                             rays.view.data()});
    const typename FieldOnGrid<Grid>::Parameters at{parameters_.value(kJointColumns), parameters_.grad(kJointColumns),
                                                    rows(boundary)};
    const auto sampled = field_->evaluate(at, field_->points_of(rays));
    const auto volume = field_->render(rays, sampled, p_.background);
    Floats weights;
    if (t.density) {
      weights = {grid_, view.pixels()};
      const DensityWeight kernel{{}, 0, 0, 0, 0, view.width_px, volume.optical_depth.data(), weights.data()};
      grid_.each(view.pixels(), DensityWeightOfView{kernel, rays.view.data()});
    }
    if (t.align) {
      const Floats grad_colour(grid_, rays.rays * 3), grad_alpha(grid_, rays.rays);
      const RayValues<float> to_field{grad_colour.data(), grad_alpha.data()};
      align_term(grid_, view, t, rays, rendered, {volume.colour.data(), volume.alpha.data()}, grad, to_field, sums_.data());
      field_->back_from(at, rays, {sampled, volume}, p_.background, to_field);
    }
    if (t.smooth)
      field_->smooth(at, rays, {t.lambda_smooth, t.smooth_points, t.smooth_scale, p_.seed, &parameters_.on_clock()->done},
                     sums_.data() + kSumSmooth);
    return weights;
  }

  /// Those of the model before the first step.
  RaysOnGrid<Grid> initial_rays(const View& view, const Camera& camera, const RayCamera& ray) {
    if (!initial_)
      initial_.emplace(grid_, CloudView<float>{n_, p_.initial.position.data(), p_.initial.rotation.data(),
                                               p_.initial.log_scale.data(), p_.initial.logit_opacity.data(), nullptr, nullptr,
                                               0, 0, p_.initial.usable.data(), nullptr});
    const Floats boundary = boundary_of(initial_->view().position);
    const RenderedOnGrid<Grid> rendered(grid_, p_.terms.pixel_windows ? view.pixels() : 0, false, 0, true, true);
    if (!p_.terms.pixel_windows) return sampled_rays(grid_, p_, ray, rows(boundary), {});
    const ChannelPlan<float> plan{false, true, {}};
    const PairRoom room = this->room();
    GridSplat<Grid>(grid_, camera, p_.initial_splat, initial_->view(), plan, {0, 0, 0}, &room)
        .forward(rendered.template planes<float>(plan));
    return sampled_rays(grid_, p_, ray, rows(boundary),
                        {rendered.depth.data(), rendered.alpha.data(), view.width_px, view.height_px});
  }

  void continuity() {
    const std::int64_t n = boundary_row_.size();
    const Floats colour(grid_, n * 3), term(grid_, n), grad(grid_, n * 3);
    grid_.each(n * 3, BoundaryColours{boundary_row_.data(), parameters_.value(kJointDc), colour.data()});
    const ContinuityGraph<float> graph{cont_.indices(), cont_.row_begin.data(), cont_.edge.data(), nullptr, {colour.data(), n}};
    grid_.each(n, ContinuityForward<float>{graph, term.data()});
    sums_on_grid(grid_, static_cast<const float*>(term.data()), n, 1, sums_.data() + kSumCont);
    float* const dc = parameters_.wanted(kJointDc);
    if (dc == nullptr) return;
    grid_.each(n, ContinuityBackward<float>{graph, float(p_.terms.lambda_cont / double(n)), {grad.data(), n}});
    grid_.each(n * 3, AddColourGradients{boundary_row_.data(), grad.data(), frozen_.data(), dc});
  }

  Grid& grid_;
  JointProblem p_;
  DeviceSums device_sums_;
  std::int64_t n_;
  JointParameters<Grid> parameters_;
  DeviceBuffer<Grid, std::uint8_t> usable_, trainable_, frozen_;
  DeviceBuffer<Grid, std::uint32_t> boundary_row_;
  DeviceBuffer<Grid, double> sums_;
  DeviceBuffer<Grid, std::int64_t> most_pairs_;
  GraphOnGrid<Grid> cont_;
  std::optional<FieldOnGrid<Grid>> field_;
  std::optional<CloudOnGrid<Grid>> initial_;
  std::vector<std::unique_ptr<View>> views_;
  std::int64_t pair_capacity_ = 0;  // the first step says how much it takes
  struct LastView {
    PixelRegion region;
    std::int64_t photo_pixels = 0, known = 0;
  } last_;
};

template <class Grid>
class GridJointOps final : public DeviceJointOps {
 public:
  GridJointOps(Grid& grid, DeviceSums sums) : grid_(grid), sums_(sums) {}
  std::unique_ptr<DeviceJoint> start(const JointProblem& problem) const override {
    return std::make_unique<GridJoint<Grid>>(grid_, problem, sums_);
  }

 private:
  Grid& grid_;
  DeviceSums sums_;
};

}  // namespace ngs
