#include "ngs/cut/training/joint_trainer.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "ngs/core/rng.h"
#include "ngs/cut/evidence/method_labels.h"
#include "ngs/cut/training/first_queries.h"
#include "ngs/cut/training/trained_labels.h"
#include "ngs/cut/training/view_cache.h"
#include "ngs/make/fit/fit_stage.h"
#include "ngs/math/sh.h"
#include "ngs/ops/losses/loss_cont.h"
#include "ngs/ops/losses/loss_mask.h"
#include "ngs/ops/losses/photometric.h"
#include "ngs/ops/neighbours/knn.h"
#include "ngs/problem/trained_rows.h"
#include "ngs/problem/view_list.h"

namespace ngs {
namespace {

GroupRates group_rates(const JointSetup& s, const JointSwitches& effects) {
  const GaussianRates& r = s.rates;
  const double extent = scene_extent(cameras_of(s.input.scene, s.input.views));
  GroupRates rates{r.position * extent, r.rotation, r.log_scale, r.logit_opacity, r.sh_dc, r.sh_rest};
  for (double& rate : rates) rate = rate * s.options.rate_scale;
  if (!effects.geometry) rates = {};
  if (!effects.sh) rates[kGroupRest] = 0;
  return rates;
}

SplatOptions splat_of(SplatOptions splat, const JointSwitches& effects) {
  if (!effects.sh) splat.max_sh_degree = 0;
  return splat;
}

}  // namespace

BoundarySet boundary_to_train(const Problem& input, bool boundary_effect, bool allow_empty) {
  BoundarySet boundary = boundary_set(input.cloud, boundary_flags(input, boundary_effect));
  if (boundary.size() == 0 && !allow_empty)
    throw Error(ErrorCode::kNothingFound, "the boundary set is empty",
                "lower --tau of ngs-variance, or pass --allow-empty to train labels alone");
  return boundary;
}

struct JointTrainer::Impl {
  Exec exec;
  Monitor& monitor;
  JointOptions options;
  JointSwitches effects;
  SampleOptions sample;
  RbfOptions rbf;
  const Problem& input;
  const QueryField* given_field;
  GroupRates rates;  // at the first step, before decay

  GaussianCloud cloud;
  TrainedRows trained;
  TrainedLabels labels;
  BoundarySet boundary;
  std::unique_ptr<JointField> field;
  SplatOptions first_splat;  // of the initial model, in the first round over the views
  std::int64_t steps = 0, done = 0;

  ResidentResults images;  // of `splat`, and the following arrays
  SplatPass splat;
  ViewGradients image_grad;
  StepTiles tiles;
  ImageF pixel_weights;           // of the losses
  std::vector<float> kept_photo;  // of a view outside the cache, like kept_near
  TileFlags kept_near;
  AlignContext align_context;
  AlignFieldGradients to_field;
  PhotometricPass<float> photometric;
  CloudGradients gradients;
  GaussianMoments moments;
  KnnGraph cont_graph;
  std::vector<std::int32_t> cont_place;       // [B] rows of the gradients; -1: not trained
  std::vector<float> cont_colour, cont_grad;  // [B, 3]
  ViewCache cache;
  Resident resident;  // all arrays of a step, while steps run on a device

  Impl(const Exec& e, Monitor& m, const JointSetup& s)
      : exec(e),
        monitor(m),
        options(s.options),
        effects(s.options.on),
        sample(sample_of(s.sample, s.options, s.input.splat.world_unit)),
        rbf(s.rbf),
        input(s.input),
        given_field(s.field),
        rates(group_rates(s, effects)),
        cloud(s.input.cloud),
        trained(e, s.input.region, s.frozen.empty() ? s.input.frozen : s.frozen, cloud),
        labels(trained),
        images(e),
        splat(trained.prepared(splat_of(s.input.splat, effects)), &images),
        cache(e, input, options),
        resident(e) {}

  void start(bool allow_empty) {
    boundary = boundary_to_train(input, effects.boundary, allow_empty);
    if (boundary.size() == 0) effects.nerf = false;
    if (!effects.nerf) effects.align = effects.density = effects.smooth = effects.variance = false;
    steps = steps_of(options, input.views.size());
    labels.start(input, options.start_steps);
    if (boundary.size() > 1) {
      cont_graph = nearest_others(exec, boundary.positions(), rbf.neighbours);
      build_transpose(cont_graph);
      cont_colour.resize(boundary.row.size() * 3), cont_grad.resize(boundary.row.size() * 3);
      for (const std::uint32_t row : boundary.row) {
        const std::optional<std::size_t> place = trained.gradient_row(row);
        cont_place.push_back(place ? std::int32_t(*place) : -1);
      }
    }
    if (effects.nerf) {
      first_splat = given_field ? input.splat : kept_on_device(exec, input.splat, input.cloud);
      const double reach = field_reach(sample, cloud, cameras_of(input.scene, input.views), boundary);
      field = std::make_unique<JointField>(
          exec, JointField::Setup{options, effects, sample, rbf, cloud, boundary, reach, input.seed});
    }
  }

  /// Copies the trained values to the rendered cloud, labels and boundary.
  void write_back(const Exec& where, const std::vector<std::uint8_t>* changed = nullptr) {
    labels.write_back(where);
    trained.write_back(where, changed);
    if (!field) return;
    for_each_row(where, boundary.size(),
                 GatherRows{boundary.row.data(), 3, cloud.position.data(), boundary.position.data()});
    if (where.device_ops) resident.update_host(boundary.position);  // rays are sampled on the host
  }

  /// Moves all arrays of a step to the device, if there is one.
  void to_device() {
    if (!resident.waits()) return;
    gradients.resize(trained.size(), std::size_t(cloud.rest_count()) * 3, input.labels.size());
    for (const GroupColumns& group : kGroupColumns) resident.add(gradients.*group.gradient);
    resident.add(gradients.label), resident.add(gradients.mean_px), resident.add(gradients.visible);
    for (std::size_t g = 0; g < kGaussianGroups && effects.geometry; ++g) {
      if (rates[g] == 0) continue;
      moments[g].m.resize((gradients.*kGroupColumns[g].gradient).size()), moments[g].v.resize(moments[g].m.size());
      resident.add(moments[g].m), resident.add(moments[g].v);
    }
    trained.add_to(resident), labels.add_to(resident);
    resident.add(cont_graph.index), resident.add(cont_graph.row_begin), resident.add(cont_graph.edge);
    if (field) field->add_to(resident), resident.add(boundary.position), resident.update_host(boundary.position);
    resident.add(boundary.row), resident.add(cont_place), resident.add(cont_colour), resident.add(cont_grad);
  }

  std::string step_name(std::int64_t s) const {
    return "view '" + input.scene.views[input.views[view_of(s)]].camera.name + "', step " + std::to_string(s + 1);
  }

  /// Position in input.views of step `s` (from 0). Every round is a new permutation.
  std::size_t view_of(std::int64_t s) const {
    const auto n = input.views.size();
    const std::uint64_t round = std::uint64_t(s) / n;
    std::vector<std::size_t> order(n);
    std::iota(order.begin(), order.end(), std::size_t(0));
    for (std::size_t i = n; i-- > 1;)
      std::swap(order[i], order[rng_bits(input.seed, RngStream::kViewOrder, round * n + i) % (i + 1)]);
    return order[std::size_t(s) % n];
  }

  FirstQueries first_queries() const {
    return {exec, sample, rbf, input, first_splat, effects.boundary, given_field, *field};
  }

  const FieldRays& rays_of(std::size_t n, const RenderedView& rendered) {
    const auto timed = monitor.scope("rays");
    const std::size_t v = input.views[n];
    const Camera& world = input.scene.views[v].camera;
    const Camera camera = relative_to(world, cloud.origin);
    const DepthMap map{&rendered.depth, &rendered.alpha, &exec};
    FieldRays rays;
    if (done < std::int64_t(input.views.size())) {
      rays = first_queries().rays(v);
    } else {
      first_splat.prepared.reset();
      rays.rays = sample_view(exec, sample, camera, boundary.positions(), map).rays;
    }
    if (rays.rays.rays() > 0) rays.on_surface = rays_on_surface(camera, rays.rays, map);
    return field->hold(exec, std::move(rays), boundary.positions());
  }

  LossTerms step_view(std::size_t n);
  const ImageF* field_terms(const FieldRays& rays, const RenderedView& rendered, LossTerms& loss, ViewGradients& grad);
  ViewGradients& shaped_gradients(const RenderedView& rendered, bool with_masks, bool with_photo);
  const std::vector<float>& choose_tiles(std::size_t n, const ViewCache::View& view);
  void cont_term(LossTerms& loss);
  void update(double decay);
  void set_total(LossTerms& loss) const;
};

/// Adds the terms of the field. Returns the density weights of the mask loss; null: all 1.
const ImageF* JointTrainer::Impl::field_terms(const FieldRays& rays, const RenderedView& rendered, LossTerms& loss,
                                              ViewGradients& grad) {
  if (rays.rays.rays() == 0) return nullptr;
  const auto timed = monitor.scope("field");
  const VolumeOutput& volume = field->forward(exec, rays, boundary.positions(), input.background);
  if (effects.density) {
    const PixelGrid& g = rays.rays.grid;
    images.shape(pixel_weights, rendered.width_px, rendered.height_px, 1);
    density_weights(exec, {g, box_of(g), volume.optical_depth}, pixel_weights);
  }
  if (effects.align) {
    const AlignOptions align{options.weight_opacity, effects.variance ? options.weight_variance : 0.0};
    const AlignInputs in{.grid = rays.rays.grid,
                         .colour = &rendered.colour,
                         .alpha = &rendered.alpha,
                         .field_colour = &volume.colour,
                         .field_alpha = &volume.alpha,
                         .active = &rays.on_surface};
    AlignContext& context = align_context;
    const std::size_t nodes = volume.alpha.size();
    images.shape(context.colour_residual, nodes * 3), images.shape(context.alpha_residual, nodes);
    images.shape(context.patch_mean, nodes * 3), images.shape(context.patch_share, nodes);
    images.shape(to_field.colour, nodes * 3), images.shape(to_field.alpha, nodes);
    const AlignLoss value = loss_align(exec, align, in, context);
    loss_align_backward(exec, align, in, context, {1.0, to_field, grad.colour, grad.alpha});
    loss.align = value.total;
  }
  if (effects.align) field->backward(exec, rays, boundary.positions(), input.background, to_field);
  if (effects.smooth) loss.smooth = field->smoothness(exec, rays, boundary.positions(), options.lambda_smooth, done);
  return effects.density ? &pixel_weights : nullptr;
}

/// The gradients of the images; zero where no loss overwrites them, empty where none adds to them.
ViewGradients& JointTrainer::Impl::shaped_gradients(const RenderedView& rendered, bool with_masks, bool with_photo) {
  const int w = rendered.width_px, h = rendered.height_px;
  ViewGradients& grad = image_grad;
  grad.label_moves_geometry = effects.mask_geometry;
  images.shape(grad.label, w, h, effects.mask && with_masks ? rendered.label.channels : 0);
  images.shape(grad.alpha, w, h, effects.align ? 1 : 0);
  images.shape(grad.colour, w, h, rendered.colour.channels);
  fill_zero(exec, grad.alpha.data);
  if (!with_photo) fill_zero(exec, grad.colour.data);
  return grad;
}

void JointTrainer::Impl::cont_term(LossTerms& loss) {
  if (!effects.cont || cont_graph.queries() == 0) return;
  for_each_row(exec, boundary.size(), RowColours{boundary.row.data(), cloud.sh_dc.data(), cont_colour.data()});
  const AddRowColourGradients add{cont_place.data(), nullptr, gradients.sh_dc.data()};
  loss.cont =
      loss_cont(exec, {cont_graph, {cont_colour.data(), boundary.size()}}, options.lambda_cont, &cont_grad, &add);
}

/// Sets `tiles` and pixel_weights for a step that leaves out tiles; returns the photo, on the device if there is one.
const std::vector<float>& JointTrainer::Impl::choose_tiles(std::size_t n, const ViewCache::View& view) {
  const int w = view.masks.width_px, h = view.masks.height_px;
  tiles = step_tiles(view.near, w, h, input.seed, done);
  images.shape(pixel_weights, w, h, 1);
  const bool copied = exec.device_ops != nullptr && !cache.keeps(n);
  if (copied) {
    images.assign(kept_photo, std::vector<float>(view.photo.data));
    images.assign(kept_near, TileFlags(view.near));
  }
  weigh_pixels(exec, copied ? kept_near : view.near, tiles, pixel_weights);
  return copied ? kept_photo : view.photo.data;
}

LossTerms JointTrainer::Impl::step_view(std::size_t n) {
  ViewCache::View scratch;
  const ViewCache::View& view = cache.load(monitor, n, scratch);
  const Camera& camera = input.scene.views[input.views[n]].camera;
  RenderRequest request;
  request.colour = effects.photometric || effects.align, request.depth = effects.nerf,
  request.background = input.background;
  request.label = labels.rendered();
  const std::vector<float>* shown_photo = view.near.empty() ? nullptr : &choose_tiles(n, view);
  if (shown_photo) request.tiles = tiles.rendered.data();
  RenderedView& rendered = [&]() -> RenderedView& {
    const auto timed = monitor.scope("splat forward");
    return splat.forward(exec, cloud, camera, request);
  }();
  const double shown = window_share(input, input.views[n]);  // scales losses to means over uncropped views
  LossTerms loss;
  const bool with_photo = effects.photometric && !view.photo.empty();
  ViewGradients& grad = shaped_gradients(rendered, view.masks.available, with_photo);
  const ImageF* weights = shown_photo ? &pixel_weights : nullptr;
  if (with_photo) {
    const auto timed = monitor.scope("photometric");
    if (weights) keep_weighted(exec, *weights, shown_photo, rendered.colour);
    const PixelRect& box = view.anchor;
    const double inside = box.empty() ? 1 : double(box.x1 - box.x0) * (box.y1 - box.y0) / double(view.photo.pixels());
    const double weight = weights ? tiles.weight : 0;
    const double share = shown * (weights ? weight / double(view.photo.pixels()) : inside);
    const PhotometricOptions anchor{
        .box = box, .gradient_scale = share * options.photometric_weight, .weight_sum = weight};
    loss.photometric =
        share * photometric.evaluate(exec, anchor, {rendered.colour, view.photo, weights}, &grad.colour).total;
    if (weights) keep_weighted(exec, *weights, nullptr, grad.colour);
  }
  if (effects.nerf) weights = field_terms(rays_of(n, rendered), rendered, loss, grad);
  if (effects.mask && view.masks.available) {
    const auto timed = monitor.scope("mask loss");
    loss.mask = loss_mask(exec, {MaskLossForm::kBce, 1.0}, {&rendered.label, &view.masks, weights, shown},
                          options.lambda_mask, &grad.label)
                    .total;
  }
  {
    const auto timed = monitor.scope("splat backward");
    splat.backward(exec, grad, gradients, trained.wanted());  // rows that are not wanted keep zero moments
  }
  cont_term(loss);
  set_total(loss);
  return loss;
}

void JointTrainer::Impl::set_total(LossTerms& loss) const {
  loss.total = options.photometric_weight * loss.photometric + loss.align + options.lambda_mask * loss.mask +
               options.lambda_cont * loss.cont + options.lambda_smooth * loss.smooth;
}

void JointTrainer::Impl::update(double decay) {
  const auto timed = monitor.scope("adam");
  const std::int64_t t = done + 1;
  std::vector<AdamGroup> groups;
  groups.push_back(labels.group(exec, options.rate_label * decay, gradients.label));
  if (options.at_contours) groups.back().options.sparse_columns = 1;
  if (effects.geometry) {
    GroupRates fallen = rates;
    for (double& rate : fallen) rate *= decay;
    for (const AdamGroup& group :
         gaussian_groups({t, fallen, options.at_contours}, gradients, trained.cloud(), moments))
      groups.push_back(group);
  }
  adam_step(exec, t, groups);
  write_back(exec, options.at_contours ? &gradients.visible : nullptr);
  if (field) field->step(exec, t, decay);
}

JointTrainer::JointTrainer(const Exec& exec, Monitor& monitor, const JointSetup& setup, bool allow_empty)
    : impl_(std::make_unique<Impl>(exec, monitor, setup)) {
  impl_->start(allow_empty);
}
JointTrainer::~JointTrainer() = default;

bool JointTrainer::finished() const { return impl_->done >= impl_->steps; }
void JointTrainer::plan_steps(std::int64_t steps) { impl_->steps = std::max(steps, impl_->done); }
std::int64_t JointTrainer::steps_done() const { return impl_->done; }
std::int64_t JointTrainer::steps_planned() const { return impl_->steps; }

JointProgress JointTrainer::step() {
  Impl& s = *impl_;
  s.to_device();
  const std::size_t n = s.view_of(s.done);
  JointProgress progress;
  with_context(s.step_name(s.done), [&] {
    progress.loss = s.step_view(n);
    s.update(std::pow(kRateDecay, double(s.done) / double(s.steps)));
  });
  ++s.done;
  progress.step = s.done, progress.steps = s.steps, progress.view = s.input.views[n];
  return progress;
}

Solution JointTrainer::result() const {
  impl_->resident.release();
  const Impl& s = *impl_;
  Solution result;
  result.cloud = std::make_shared<const GaussianCloud>(s.cloud);
  result.labels = s.input.labels;
  result.converged = finished();
  s.labels.write(result.labels);
  result.figures = figures();
  return result;
}

std::map<std::string, double> JointTrainer::figures() const {
  return {{"steps", double(impl_->done)}, {"boundary", double(impl_->boundary.size())}};
}

std::vector<StateBlock> JointTrainer::state() {
  Impl& s = *impl_;
  s.resident.release();
  std::vector<StateBlock> blocks;
  const auto moments = [&](const std::string& name, AdamMoments& m, std::size_t size) {
    blocks.push_back({name + ".m", &m.m, size, true});
    blocks.push_back({name + ".v", &m.v, size, true});
  };
  const auto stepped = [&](const std::string& name, std::vector<float>& values, AdamMoments& m) {
    blocks.push_back({name, &values, values.size()});
    moments(name, m, values.size());
  };
  for (std::size_t g = 0; g < kGaussianGroups; ++g)
    stepped(kGroupColumns[g].name, s.trained.cloud().*kGroupColumns[g].value, s.moments[g]);
  stepped("label", s.labels.logit(), s.labels.moments());
  if (s.field) {
    ParamStore& store = s.field->parameters();
    blocks.push_back({"field", &store.values, store.values.size()});
    for (std::size_t b = 0; b < s.field->moments().size(); ++b)
      moments("field." + std::to_string(b), s.field->moments()[b], store.blocks[b].size);
  }
  return blocks;
}

void JointTrainer::resume_at(std::int64_t step) {
  impl_->done = step;
  impl_->resident.release();
  impl_->write_back({.threads = impl_->exec.threads});
}

}  // namespace ngs
