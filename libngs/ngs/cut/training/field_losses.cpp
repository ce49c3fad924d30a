// The losses of the paper's NeRF: L_align, L_smth, and the density weights of L_mask.   Eqs. (1), (4)-(16), (18)
// The first step of a view uses query points of the initial model, read from a file of ngs-sample and ngs-rbf if one is
// given. Later steps sample them from the current model (C23).
#include <algorithm>

#include "ngs/cut/training/loss_list.h"
#include "ngs/cut/training/loss_term.h"
#include "ngs/cut/training/scene_probe.h"
#include "ngs/field/joint_field.h"
#include "ngs/ops/image/mask_pair.h"
#include "ngs/ops/losses/loss_mask.h"
#include "ngs/ops/optim/rows.h"
#include "ngs/problem/scene_measures.h"
#include "ngs/problem/view_list.h"

namespace ngs {
namespace {

struct FieldWeights {
  double opacity = 0.5, variance = 0.01, smooth = 0.05;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.smooth, Field<double>{"lambda_smooth", "", "Weight of L_smth (Eq. 20)", 0, 1e6}.of("smooth"));
    visit(self.opacity,
          Field<double>{"weight_opacity", "", "Opacity weight w_alpha of L_align (Eq. 16)", 0, 1e6}.of("align"));
    visit(self.variance,
          Field<double>{"weight_variance", "", "Variance weight w_v of L_align (Eq. 16, C17)", 0, 1e6}.of("variance"));
  }
};

double gap_without_photos(SceneProbe& probe) {
  return probe.boundary().size() == 0 ? 0 : 1 - probe.label_sample().biou;
}

bool has_no_photo(const Problem& problem) { return photo_count(problem.scene, problem.views) == 0; }

double finest_cell(SceneProbe& probe) {
  if (probe.boundary().size() < 2) return 0;
  const TrainingOptions& o = probe.training();
  const Problem& p = probe.problem();
  const double reach = field_reach(o.sample, p.cloud, cameras_of(p.scene, p.views), probe.boundary());
  const double width = rbf_width(probe.exec(), o.rbf, probe.boundary().positions());
  return encoding_cells(probe.exec(), reach, width, probe.boundary().positions(), o.joint.hash_finest);
}

double patch_deviation(SceneProbe& probe) {
  double most = 0;
  for_each_view(probe.problem().monitor, probe.sample_views(), [&](std::size_t, std::size_t v) {
    const ViewMasks masks = probe.problem().load_masks(v);
    const ImageF photo = probe.problem().load_photo(v);
    if (!masks.available || photo.empty()) return;
    for (const std::vector<float>& target : masks.target) {
      const std::vector<std::uint8_t> plane = object_pixels(target);
      most = std::max(most, contour_deviation_levels(photo, {plane.data(), masks.width_px, masks.height_px}));
    }
  });
  return most;
}

const Effect kParts[] = {
    {.name = kNerfEffect,
     .help = "train a NeRF and the terms that need it",
     .saves = "rays, field, network, L_align, L_smth",
     .needs = kJointEffect,
     .heuristic = {"without photos: 1 - boundary IoU of the closed-form labels with the masks", 0.02,
                   "two points: masks of one object differ as much between tools", gap_without_photos, has_no_photo,
                   "there are photos; in addition to them the NeRF gained nothing"},
     .skipped_with_budget = true},
    {.name = "box",
     .help = "sample in the boundary's box; off: in the whole image",
     .always = "off is more work, not less"},
    {.name = "rbf",
     .help = "interpolate features by RBF; off: nearest feature",
     .saves = "all neighbours of a query point except the nearest",
     .needs = kNerfEffect,
     .heuristic = {"largest colour difference between neighbours, levels", 0.5, kHalfLevel,
                   [](SceneProbe& probe) {
                     return neighbour_max_levels(probe.boundary_neighbours(), probe.boundary_colours());
                   }}},
    {.name = "hash",
     .help = "multi-level hash encoding; off: one coarse level",
     .saves = "all levels except one",
     .needs = kNerfEffect,
     .always = "with one level the network costs as much"},
    {.name = "fine-hash",
     .help = "use hash levels finer than the boundary's spacing",
     .saves = "levels with cells below half the boundary's spacing",
     .needs = kNerfEffect,
     .heuristic = {"side of the finest cell, in spacings of the boundary", kFinestCell,
                   "two cells per spacing: finer detail has no support", finest_cell}},
    {.name = "film",
     .help = "condition the network on f_inter",
     .needs = kNerfEffect,
     .always = "off runs the same network"},
    {.name = "align",
     .help = "use the colour and opacity terms of L_align",
     .saves = "L_align and its gradients",
     .needs = kNerfEffect,
     .always = "the field is trained by it"},
    {.name = "variance",
     .help = "use the 7x7 variance term of L_align",
     .saves = "the pass over the patches",
     .needs = "align",
     .heuristic = {"standard deviation of 7x7 patches at the masks' contours, levels", 0.5, kHalfLevel,
                   patch_deviation}},
    {.name = "density",
     .help = "weight L_mask by density",
     .needs = kNerfEffect,
     .always = "a by-product of the field"},
    {.name = "smooth",
     .help = "use L_smth",
     .saves = "two more evaluations of the field",
     .needs = kNerfEffect,
     .heuristic = {"range of the boundary's colours, levels", 0.5, kHalfLevel,
                   [](SceneProbe& probe) { return colour_range_levels(probe.boundary_colours()); }}},
};

/// The sampling options of a run: the whole image if the effect `box` is off, and half of the nodes and depths along
/// each axis if the preset halves the samples.
SampleOptions sample_of(SampleOptions sample, const JointOptions& options, double world_unit) {
  sample.whole_image = !options.on("box");
  sample.world_unit = world_unit;
  if (!preset_of(options.quality).half_samples) return sample;
  for (int* count : {&sample.rows, &sample.cols, &sample.depth_samples}) *count = (*count + 1) / 2;
  return sample;
}

class FieldTerms final : public LossTerm {
 public:
  explicit FieldTerms(const FieldWeights& weights = {}) : weights_(weights) {}
  std::vector<Effect> effects() const override { return {std::begin(kParts), std::end(kParts)}; }
  std::vector<std::string_view> columns() const override { return {"align", "smooth"}; }
  void declare(OptionSet& options, const OptionGroup& group) override { options.add(weights_, group); }
  std::unique_ptr<LossTerm> copy() const override { return std::make_unique<FieldTerms>(weights_); }

  bool start(const TrainedModel& model) override {
    model_ = &model;
    const Problem& input = model.input;
    if (model.boundary.size() == 0 || model.options.at_contours) return false;  // rays cross the whole view
    position_ = model.boundary.position;
    sample_ = sample_of(model.sample, model.options, input.splat.world_unit);
    first_splat_ = input.splat;
    if (!model.field) first_splat_ = prepared_for_device(model.exec, input.splat, input.cloud);
    results_ = std::make_unique<ResidentResults>(model.exec);
    const double reach = field_reach(sample_, model.cloud, cameras_of(input.scene, input.views), model.boundary);
    field_ =
        std::make_unique<JointField>(model.exec, JointField::Setup{model.options, model.options, sample_, model.rbf,
                                                                   model.cloud, model.boundary, reach, input.seed});
    return true;
  }
  void request(RenderRequest& request) const override {
    request.colour |= on("align");
    request.depth = true;
  }
  void add_on_view(LossStep& step) override {
    const Exec& exec = model_->exec;
    const FieldRays& rays = rays_of(step);
    rays_ = &rays;
    if (on("align")) step.images.added(&ViewGradients::alpha);
    if (rays.rays.rays() == 0) return;
    const auto timed = model_->monitor.scope("field");
    const VolumeOutput& volume = field_->forward(exec, rays, positions(), model_->input.background);
    if (on("density")) {
      const PixelGrid& grid = rays.rays.grid;
      results_->shape(pixel_weight_, step.rendered.width_px, step.rendered.height_px, 1);
      density_weights(exec, {grid, box_of(grid), volume.optical_depth}, pixel_weight_);
      step.pixel_weight = &pixel_weight_;
    }
    if (on("align")) align(step, rays, volume);
  }
  void add_on_model(LossStep& step) override {
    if (!on("smooth") || rays_->rays.rays() == 0) return;
    const auto timed = model_->monitor.scope("field");
    const double loss = field_->smoothness(model_->exec, *rays_, positions(), weights_.smooth, step.number);
    step.values.set("smooth", weights_.smooth, loss);
  }
  void add_to(Resident& resident) override {
    field_->add_to(resident);
    resident.add(position_);
    resident.update_host(position_);
  }
  void follow_model(const Exec& exec, const Resident& resident) override {
    const BoundarySet& boundary = model_->boundary;
    for_each_row(exec, boundary.size(),
                 GatherRows{boundary.row.data(), 3, model_->cloud.position.data(), position_.data()});
    if (!resident.waits()) resident.update_host(position_);  // rays are sampled on the host
  }
  void update(std::int64_t number, double decay) override { field_->step(model_->exec, number, decay); }
  void add_state(std::vector<StateBlock>& blocks) override {
    ParamStore& store = field_->parameters();
    blocks.push_back({"field", &store.values, store.values.size()});
    for (std::size_t b = 0; b < field_->moments().size(); ++b)
      add_moments("field." + std::to_string(b), field_->moments()[b], store.blocks[b].size, blocks);
  }

 private:
  bool on(std::string_view part) const { return model_->options.on(part); }
  Rows<const float, 3> positions() const { return {position_.data(), model_->boundary.size()}; }
  /// The rays of a view with query points of the initial model. kInconsistent: the given field lacks the view.
  FieldRays first_rays(std::size_t view) const {
    const Exec& exec = model_->exec;
    const Problem& input = model_->input;
    const BoundarySet& initial = model_->boundary;
    const QueryField* const given = model_->field;
    const Camera& world = input.scene.views[view].camera;
    const Camera camera = relative_to(world, input.cloud.origin);
    if (given == nullptr) {
      Monitor quiet;
      QueryField sampled =
          sample_queries(exec, quiet, sample_, {input.cloud, initial, input.scene, {view}, first_splat_});
      interpolate_features(exec, quiet, model_->rbf, initial, sampled);
      return field_->rays(exec, camera, sampled, 0, initial);
    }
    for (std::size_t i = 0; i < given->views.size(); ++i)
      if (given->views[i].name == world.name) return field_->rays(exec, camera, *given, i, initial);
    throw Error(ErrorCode::kInconsistent, "the field has no view '" + world.name + "', expected every training view",
                "sample again: ngs-sample scene.json boundary.ply --views all -o queries.ply");
  }
  const FieldRays& rays_of(const LossStep& step) {
    const Exec& exec = model_->exec;
    const auto timed = model_->monitor.scope("rays");
    const Problem& input = model_->input;
    const Camera camera = relative_to(input.scene.views[step.view].camera, model_->cloud.origin);
    const DepthMap map{&step.rendered.depth, &step.rendered.alpha, &exec};
    FieldRays rays;
    if (step.number < std::int64_t(input.views.size())) {
      rays = first_rays(step.view);
    } else {
      first_splat_.prepared.reset();
      rays.rays = sample_view(exec, sample_, camera, positions(), map).rays;
    }
    if (rays.rays.rays() > 0) rays.on_surface = rays_on_surface(camera, rays.rays, map);
    return field_->hold(exec, std::move(rays), positions());
  }
  void align(LossStep& step, const FieldRays& rays, const VolumeOutput& volume) {
    const Exec& exec = model_->exec;
    const AlignOptions options{weights_.opacity, on("variance") ? weights_.variance : 0.0};
    const AlignInputs in{.grid = rays.rays.grid,
                         .colour = &step.rendered.colour,
                         .alpha = &step.rendered.alpha,
                         .field_colour = &volume.colour,
                         .field_alpha = &volume.alpha,
                         .active = &rays.on_surface};
    AlignContext& context = align_context_;
    const std::size_t nodes = volume.alpha.size();
    for (std::vector<float>* values : {&context.colour_residual, &context.patch_mean, &to_field_.colour})
      results_->shape(*values, nodes * 3);
    for (std::vector<float>* values : {&context.alpha_residual, &context.patch_share, &to_field_.alpha})
      results_->shape(*values, nodes);
    const AlignLoss loss = loss_align(exec, options, in, context);
    loss_align_backward(
        exec, options, in, context,
        {1.0, to_field_, step.images.added(&ViewGradients::colour), step.images.added(&ViewGradients::alpha)});
    field_->backward(exec, rays, positions(), model_->input.background, to_field_);
    step.values.set("align", 1, loss.total);
  }

  FieldWeights weights_;
  const TrainedModel* model_ = nullptr;
  SampleOptions sample_;
  SplatOptions first_splat_;     // of the initial model, in the first round over the views
  std::vector<float> position_;  // [B, 3] of the boundary, current
  std::unique_ptr<JointField> field_;
  std::unique_ptr<ResidentResults> results_;  // the following arrays
  ImageF pixel_weight_;
  AlignContext align_context_;
  AlignFieldGradients to_field_;
  const FieldRays* rays_ = nullptr;  // of the step
};

}  // namespace

std::unique_ptr<LossTerm> make_field_losses() { return std::make_unique<FieldTerms>(); }

}  // namespace ngs
