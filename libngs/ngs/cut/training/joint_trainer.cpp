#include "ngs/cut/training/joint_trainer.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "ngs/backend/for_each.h"
#include "ngs/core/rng.h"
#include "ngs/cut/evidence/method_labels.h"
#include "ngs/cut/training/trained_labels.h"
#include "ngs/cut/training/view_cache.h"
#include "ngs/make/fit/fit_stage.h"
#include "ngs/problem/trained_rows.h"
#include "ngs/problem/view_list.h"

namespace ngs {
namespace {

GroupRates group_rates(const JointSetup& s) {
  const GaussianRates& r = s.rates;
  const double extent = scene_extent(cameras_of(s.input.scene, s.input.views));
  GroupRates rates{r.position * extent, r.rotation, r.log_scale, r.logit_opacity, r.sh_dc, r.sh_rest};
  for (double& rate : rates) rate = rate * s.options.rate_scale;
  if (!s.options.on("geometry")) rates = {};
  if (!s.options.on("sh")) rates[kGroupRest] = 0;
  return rates;
}

SplatOptions splat_of(const JointSetup& s) {
  SplatOptions splat = s.input.splat;
  if (!s.options.on("sh")) splat.max_sh_degree = 0;
  return splat;
}

/// [N] 1: in the boundary set of some object. If `boundary_effect` is false: seen by some view.
std::vector<float> boundary_flags(const Problem& input, bool boundary_effect) {
  std::vector<float> flags(std::size_t(input.cloud.size()), 0.f);
  for (const LabelColumns& object : input.labels)
    for (std::size_t i = 0; i < flags.size(); ++i)
      if (boundary_effect ? is_set(object.boundary[i]) : object.views[i] > 0.f) flags[i] = 1.f;
  return flags;
}

}  // namespace

BoundarySet boundary_to_train(const Problem& input, bool boundary_effect, bool allow_empty) {
  BoundarySet boundary = boundary_set(input.cloud, boundary_flags(input, boundary_effect));
  if (boundary.size() == 0 && !allow_empty)
    throw Error(ErrorCode::kNothingFound, "the boundary set is empty",
                "lower --tau of ngs-variance, or pass --allow-empty to train labels alone");
  return boundary;
}

struct JointTrainer::Impl : TrainedModel {
  GroupRates rates;  // at the first step, before decay
  TrainedLabels labels;
  std::int64_t steps = 0, done = 0;

  ResidentResults rendered;  // of `splat`
  SplatPass splat;
  RenderRequest request;
  std::vector<std::unique_ptr<LossTerm>> losses;  // those that are on
  LossValues no_values;                           // all columns
  ImageGradients images;
  StepTiles tiles;
  ImageF pixel_weights;           // of the losses, in a step that leaves out tiles
  std::vector<float> kept_photo;  // of a view outside the cache, like kept_near
  TileFlags kept_near;
  CloudGradients gradients;
  GaussianMoments moments;
  ViewCache cache;
  std::vector<std::vector<double>> sums;  // of the trained columns at the ends of averaged epochs
  double summed = 0;                      // number of these epochs
  Resident resident;                      // all arrays of a step, while steps run on a device

  Impl(const Exec& e, Monitor& m, const JointSetup& s)
      : TrainedModel{e,
                     m,
                     s.options,
                     s.sample,
                     s.rbf,
                     s.input,
                     s.field,
                     s.input.cloud,
                     TrainedRows(e, s.input.region, s.frozen.empty() ? s.input.frozen : s.frozen, cloud)},
        rates(group_rates(s)),
        labels(rows),
        rendered(exec),
        splat(rows.prepared(splat_of(s)), &rendered),
        images(exec),
        cache(exec, input, s.options.at_contours),
        resident(exec) {}

  void start(const Losses& wanted, bool allow_empty) {
    if (rates[kGroupRest] == 0) rows.keep_sh_rest();
    boundary = boundary_to_train(input, options.on("boundary"), allow_empty);
    resident.add_input(boundary.row);
    steps = input.views.empty() ? 0 : steps_of(options, input.views.size());
    labels.start(input, options.start_steps);
    request.colour = false;
    request.background = input.background;
    for (const auto& loss : wanted) {
      for (const std::string_view column : loss->columns()) no_values.terms.emplace_back(column, 0.0);
      if (!options.on(loss->effects().front().name)) continue;
      losses.push_back(loss->copy());
      if (!losses.back()->start(*this)) losses.pop_back();
    }
    for (const auto& loss : losses) loss->request(request);
  }

  void write_back(const Exec& where, const std::vector<std::uint8_t>* changed = nullptr) {
    labels.write_back(where);
    rows.write_back(where, changed);
    for (const auto& loss : losses) loss->follow_model(where, resident);
  }

  void to_device() {
    if (!resident.waits()) return;
    const std::size_t rest = rows.wanted().sh_rest ? std::size_t(cloud.rest_count()) * 3 : 0;
    gradients.resize(rows.size(), rest, input.labels.size());
    for (const GroupColumns& group : kGroupColumns) resident.add(gradients.*group.gradient);
    resident.add(gradients.label);
    resident.add(gradients.mean_px);
    resident.add(gradients.visible);
    for (std::size_t g = 0; g < kGaussianGroups && options.on("geometry"); ++g) {
      if (rates[g] == 0) continue;
      moments[g].m.resize((gradients.*kGroupColumns[g].gradient).size());
      moments[g].v.resize(moments[g].m.size());
      resident.add(moments[g].m);
      resident.add(moments[g].v);
    }
    rows.add_to(resident);
    labels.add_to(resident);
    for (const auto& loss : losses) loss->add_to(resident);
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

  void average();
  const std::vector<float>& choose_tiles(std::size_t n, const ViewCache::View& given);
  LossValues step_view(std::size_t n);
  void update(double decay);
};

/// Sets `tiles` and pixel_weights for a step that leaves out tiles; returns the photo, on the device if there is one.
const std::vector<float>& JointTrainer::Impl::choose_tiles(std::size_t n, const ViewCache::View& given) {
  const int w = given.masks.width_px, h = given.masks.height_px;
  tiles = step_tiles(given.near, w, h, input.seed, done);
  rendered.shape(pixel_weights, w, h, 1);
  const bool copied = rows_are_on_device(exec) && !cache.keeps(n);
  if (copied) {
    rendered.assign(kept_photo, std::vector<float>(given.photo.data));
    rendered.assign(kept_near, TileFlags(given.near));
  }
  weigh_pixels(exec, copied ? kept_near : given.near, tiles, pixel_weights);
  return copied ? kept_photo : given.photo.data;
}

LossValues JointTrainer::Impl::step_view(std::size_t n) {
  const ViewCache::View& given = cache.load(monitor, n, request.colour);
  const std::size_t view = input.views[n];
  request.label = labels.rendered();
  const std::vector<float>* photo = given.near.empty() ? nullptr : &choose_tiles(n, given);
  request.tiles = photo ? tiles.rendered.data() : nullptr;
  RenderedView& image = [&]() -> RenderedView& {
    const auto timed = monitor.scope("splat forward");
    return splat.forward(exec, cloud, input.scene.views[view].camera, request);
  }();
  if (photo && !given.photo.empty()) {  // no difference where no tile is rendered
    const auto timed = monitor.scope("photometric");
    keep_weighted(exec, pixel_weights, photo, image.colour);
  }
  images.begin(image);
  LossStep step{*this, done, view, window_share(input, view), given, image, images, gradients, no_values};
  if (photo) {
    step.tiles = &tiles;
    step.pixel_weight = &pixel_weights;
  }
  for (const auto& loss : losses) loss->add_on_view(step);
  {
    const auto timed = monitor.scope("splat backward");
    splat.backward(exec, images.end(), gradients, rows.wanted());  // rows that are not wanted keep zero moments
  }
  for (auto loss = losses.rbegin(); loss != losses.rend(); ++loss) (*loss)->add_on_model(step);
  return step.values;
}

void JointTrainer::Impl::update(double decay) {
  const auto timed = monitor.scope("adam");
  const std::int64_t t = done + 1;
  std::vector<AdamGroup> groups;
  groups.push_back(labels.group(exec, options.rate_label * decay, gradients.label));
  if (options.at_contours) groups.back().options.sparse_columns = 1;
  if (options.on("geometry")) {
    GroupRates fallen = rates;
    for (double& rate : fallen) rate *= decay;
    for (const AdamGroup& group : gaussian_groups({t, fallen, options.at_contours}, gradients, rows.cloud(), moments))
      groups.push_back(group);
  }
  adam_step(exec, t, groups);
  write_back(exec, options.at_contours ? &gradients.visible : nullptr);
  for (const auto& loss : losses) loss->update(t, decay);
}

/// Adds the parameters to the sums at the end of an averaged epoch. After the last step they become the mean.
void JointTrainer::Impl::average() {
  const auto views = std::int64_t(input.views.size());
  const bool last = done == steps;
  const std::int64_t averaged = options.averaged_epochs * views;
  if (options.averaged_epochs < 2 || steps <= averaged) return;  // so few epochs move too far
  if (steps - done >= averaged) summed = 0;                      // plan_steps() may have moved the end
  if (steps - done >= averaged || (done % views != 0 && !last)) return;
  resident.release();
  std::vector<std::vector<float>*> columns{&labels.logit()};
  for (std::size_t g = 0; g < kGaussianGroups; ++g)
    if (rates[g] > 0) columns.push_back(&(rows.cloud().*kGroupColumns[g].value));
  if (summed == 0) sums.clear();
  sums.resize(columns.size());
  ++summed;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    std::vector<float>& values = *columns[c];
    sums[c].resize(values.size());
    for_each_index(exec, std::int64_t(values.size()), [&](std::int64_t i) {
      double& sum = sums[c][std::size_t(i)];
      sum += double(values[std::size_t(i)]);
      if (last) values[std::size_t(i)] = float(sum / summed);
    });
  }
  if (last) write_back({.threads = exec.threads});
}

JointTrainer::JointTrainer(const Exec& exec, Monitor& monitor, const JointSetup& setup, bool allow_empty)
    : impl_(std::make_unique<Impl>(exec, monitor, setup)) {
  impl_->start(setup.losses, allow_empty);
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
  s.average();
  progress.step = s.done;
  progress.steps = s.steps;
  progress.epoch_steps = std::ssize(s.input.views);
  progress.view = s.input.views[n];
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
  result.figures = {{"steps", double(s.done)}, {"boundary", double(s.boundary.size())}};
  return result;
}

std::vector<StateBlock> JointTrainer::state() {
  Impl& s = *impl_;
  s.resident.release();
  std::vector<StateBlock> blocks;
  const auto stepped = [&](const std::string& name, std::vector<float>& values, AdamMoments& m) {
    blocks.push_back({name, &values, values.size()});
    add_moments(name, m, values.size(), blocks);
  };
  for (std::size_t g = 0; g < kGaussianGroups; ++g)
    stepped(kGroupColumns[g].name, s.rows.cloud().*kGroupColumns[g].value, s.moments[g]);
  stepped("label", s.labels.logit(), s.labels.moments());
  for (const auto& loss : s.losses) loss->add_state(blocks);
  return blocks;
}

void JointTrainer::resume_at(std::int64_t step) {
  impl_->done = step;
  impl_->resident.release();
  impl_->write_back({.threads = impl_->exec.threads});
}

}  // namespace ngs
