#include "ngs/cut/contours/contour_stage.h"

#include <algorithm>
#include <numeric>
#include <optional>

#include "ngs/cut/contours/photoless_views.h"
#include "ngs/cut/contours/refined_masks.h"
#include "ngs/cut/contours/straddler_split.h"
#include "ngs/cut/contours/unexplained_contrast.h"
#include "ngs/cut/evidence/variance_stage.h"
#include "ngs/ops/splat/evidence.h"
#include "ngs/problem/coarse_input.h"
#include "ngs/problem/region.h"
#include "ngs/problem/scene_measures.h"
#include "ngs/problem/view_list.h"
#include "ngs/scene/resize.h"

namespace ngs {
namespace {

/// The largest rates with which mask and photo losses fall in every iteration. Opacities have a low one, because the
/// colours of other views depend on them. Higher rotation rates do not fit the photos better, and look worse between.
constexpr GaussianRates kContourRates{.position = 1.6e-4,
                                      .rotation = 5e-3,
                                      .log_scale = 1e-1,
                                      .logit_opacity = 7.5e-2,
                                      .sh_dc = 2.5e-2,
                                      .sh_rest = 1.25e-3};

constexpr int kLargeDetail = 2;  // multiple of the camera's size to which small photos may be enlarged

// Reduction of the image sides in a draft and in iterations before the last, without full_resolution, and factor on the
// rates of the latter: the gradients of a quarter of the pixels are noisier, and views without a photo drift more.
constexpr int kCoarseShrink = 2;
constexpr double kEarlyRate = 0.75;

// Trained Gaussians have at least this share of their weight in the windows. Background is trained only if it has more
// than this weight on the wrong side of contours.
constexpr double kMinInside = 0.99, kMinStraddling_px = 0.5;

/// Repeats the last column and row up to even sizes: a shrunk camera covers whole groups of pixels.
ImageF even_sized(ImageF photo) {
  if (photo.width_px % kCoarseShrink == 0 && photo.height_px % kCoarseShrink == 0) return photo;
  ImageF out(kCoarseShrink * shrunk_size_px(photo.width_px, kCoarseShrink),
             kCoarseShrink * shrunk_size_px(photo.height_px, kCoarseShrink), photo.channels);
  for (int y = 0; y < out.height_px; ++y)
    for (int x = 0; x < out.width_px; ++x)
      for (int c = 0; c < out.channels; ++c)
        out.at(x, y, c) = photo.at(std::min(x, photo.width_px - 1), std::min(y, photo.height_px - 1), c);
  return out;
}

/// A problem at half the size, whose fine photos have the camera's size.
class HalfSize {
 public:
  explicit HalfSize(const Problem& full) : cropped_(full, kCoarseShrink), problem_(cropped_.get()) {
    problem_.load_fine_photo = [&full](std::size_t v) { return even_sized(full.load_photo(v)); };
    if (!full.uncropped) return;
    uncropped_.emplace(*full.uncropped, kCoarseShrink, 0);
    problem_.uncropped = std::shared_ptr<const Problem>(std::shared_ptr<void>(), &uncropped_->get());
  }
  const Problem& get() const { return problem_; }

 private:
  CoarseInput cropped_;
  std::optional<CoarseInput> uncropped_;
  Problem problem_;
};

/// The model between iterations.
struct ContourModel {
  GaussianCloud cloud;
  std::vector<LabelColumns> labels;
  std::vector<std::int64_t> source_row;
  std::vector<float> fixed;
  // [source rows] 1: visible outside the windows. Set by the first iteration.
  std::vector<std::uint8_t> shows_outside = {};
};

/// [N] Weight of every Gaussian in the uncropped views.
ExactSums weight_in_all(const Exec& exec, const ContourSetup& setup, const std::vector<std::size_t>& views,
                        const GaussianCloud& cloud) {
  ExactSums weight;
  weight.resize(std::size_t(cloud.size()));
  const SplatOptions splat = prepared_for(exec, setup.problem.splat, cloud);
  for_each_view(setup.problem.monitor, views, [&](std::size_t, std::size_t v) {
    const Camera& camera = setup.problem.whole().scene.views[v].camera;
    const ViewSums seen = view_sums(exec, cloud, {camera, known_view(camera)}, splat);
    for (std::size_t r = 0; r < seen.size(); ++r) weight.add(seen.row[r], seen.weight(r));
  });
  return weight;
}

/// [N] 1: not trained: the Gaussian is frozen, or is visible outside the windows, where no photo constrains it.
/// Computed once, since whole views cost more than windows; halves inherit from their parent.
std::vector<float> untrained_rows(const Exec& exec, const ContourSetup& setup, const std::vector<std::size_t>& views,
                                  const ExactSums& inside, ContourModel& model) {
  if (model.shows_outside.empty()) {
    const ExactSums all = weight_in_all(exec, setup, views, model.cloud);
    model.shows_outside.resize(std::size_t(setup.problem.cloud.size()), 0);
    for (std::size_t i = 0; i < all.size(); ++i)
      model.shows_outside[std::size_t(model.source_row[i])] |= inside.value(i) < kMinInside * all.value(i);
  }
  const std::vector<std::uint8_t>& frozen = setup.problem.frozen;
  std::vector<float> out;
  for (const std::int64_t row : model.source_row) {
    const auto source = std::size_t(row);
    const bool is_frozen = !frozen.empty() && frozen[source];
    out.push_back(is_frozen || model.shows_outside[source] ? 1.f : 0.f);
  }
  return out;
}

/// The rows with straddling Gaussians halved. `untrained` rows are not halved: the rendering of halves differs slightly
/// until they are trained.
std::vector<CloudRow> halved_rows(std::vector<double> straddling_px, const std::vector<float>& untrained) {
  for (std::size_t i = 0; i < straddling_px.size(); ++i)
    if (untrained[i] > 0) straddling_px[i] = 0;
  return split_straddlers(straddling_px, kSplit_px);
}

void edit_model(const Exec& exec, const ContourSetup& setup, const std::vector<CloudRow>& rows, ContourModel& model) {
  edit_rows(exec, rows, setup.problem.seed, model.cloud);
  if (!model.fixed.empty()) edit_column(exec, rows, 1, model.fixed);
  edit_labels(exec, rows, model.labels);
  std::vector<std::int64_t> source;
  for (const CloudRow& row : rows) source.push_back(model.source_row[std::size_t(row.source)]);
  model.source_row = std::move(source);
}

/// What the windows show of every row.
struct SeenRows {
  std::vector<double> straddling_px;
  std::vector<std::uint8_t> visible;
  std::size_t halves = 0;  // of a split: the last rows
};

/// Evaluates the halves and the other straddling rows after a split. The labels of the halves become the
/// closed form of their own evidence.
void see_split(const Exec& exec, const Problem& window, const BoundaryRule& rule, ContourModel& model, SeenRows& seen) {
  const std::size_t n = seen.visible.size(), first = n - seen.halves;
  std::vector<std::uint8_t> chosen(n);
  for (std::size_t i = 0; i < n; ++i) chosen[i] = i >= first || seen.straddling_px[i] > kMinStraddling_px / 2;
  const RowNumbers rows(std::move(chosen));
  const Straddling across = straddling(exec, window, model.cloud, &rows);
  const std::vector<LabelColumns> closed = label_gaussians(rule, across.evidence);
  for (std::size_t r = 0; r < rows.row.size(); ++r) {
    const auto i = std::size_t(rows.row[r]);
    seen.straddling_px[i] = across.px[r];
    seen.visible[i] = across.weight.value(r) > 0;
    for (std::size_t k = 0; k < closed.size() && i >= first; ++k)
      if (closed[k].views[r] > 0) model.labels[k].prob[i] = closed[k].prob[r];
  }
}

/// The rows of an iteration. Most Gaussians of a large model are visible in no window.
struct IterationRows {
  // Rows that are visible in some window, or trained.
  std::vector<std::int64_t> rows;
  // [rows] 1: not trained: those of untrained_rows(), and background that straddles no contour.
  std::vector<std::uint8_t> frozen;
};

/// Halves the straddling Gaussians and selects the rows of the iteration.
IterationRows split_model(const Exec& exec, const ContourSetup& setup, const Problem& window, ContourModel& model) {
  Straddling across = straddling(exec, window, model.cloud);
  std::vector<float> untrained = untrained_rows(exec, setup, window.views, across.weight, model);
  SeenRows seen{std::move(across.px), std::vector<std::uint8_t>(untrained.size()), 0};
  for (std::size_t i = 0; i < untrained.size(); ++i) seen.visible[i] = across.weight.value(i) > 0;
  if (setup.contour.on.split) {
    const std::vector<CloudRow> rows = halved_rows(seen.straddling_px, untrained);
    edit_model(exec, setup, rows, model);
    edit_column(exec, rows, 1, untrained);
    const auto halves =
        std::count_if(rows.begin(), rows.end(), [](CloudRow row) { return row.origin != RowOrigin::kKept; });
    seen = {gather_column(exec, seen.straddling_px, 1, rows), gather_column(exec, seen.visible, 1, rows),
            std::size_t(halves)};
    if (halves > 0) see_split(exec, window, setup.problem.rule, model, seen);
  }
  IterationRows part;
  for (std::size_t i = 0; i < untrained.size(); ++i) {
    bool may_change = seen.straddling_px[i] > kMinStraddling_px;
    for (const LabelColumns& object : model.labels) may_change |= object.prob[i] > kMinForegroundShare;
    const bool trained = may_change && untrained[i] == 0;
    if (!trained && !seen.visible[i]) continue;
    part.rows.push_back(std::int64_t(i));
    part.frozen.push_back(!trained);
  }
  return part;
}

/// Copies the trained rows to the model.
void write_back(const Exec& exec, const Solution& trained, const std::vector<std::int64_t>& rows, ContourModel& model) {
  scatter_rows(exec, *trained.cloud, rows, model.cloud);
  scatter_labels(exec, trained.labels, rows, model.labels);
}

JointOptions window_options(const ContourSetup& setup, std::size_t views, bool early) {
  JointOptions joint = setup.training.joint;
  const int epochs = contour_epochs(setup.contour, setup.training.joint.quality, views);
  joint.steps = std::int64_t(early ? early_epochs(epochs) : epochs) * std::int64_t(views);
  joint.rate_scale = early ? kEarlyRate : 1;
  joint.start_steps = 1;  // start at the labels trained so far
  joint.at_contours = true;
  joint.averaged_epochs = preset_of(joint.quality).averaged_epochs;
  return joint;
}

/// True: the view has a photo, but windows leave it out, because it does not show the object.
bool hides_object(const Problem& problem, std::size_t view) {
  return problem.scene.views[view].image_path.empty() && !problem.whole().scene.views[view].image_path.empty();
}

/// State of the iterations.
class ContourRun {
 public:
  ContourRun(const Exec& exec, Monitor& monitor, const ContourSetup& setup, const Solution& start)
      : exec_(exec),
        monitor_(monitor),
        setup_(setup),
        model_{*start.cloud, start.labels, start.source_row, setup.problem.fixed},
        views_(setup.problem.views) {
    if (model_.source_row.empty()) {
      model_.source_row.resize(std::size_t(model_.cloud.size()));
      std::iota(model_.source_row.begin(), model_.source_row.end(), std::int64_t(0));
    } else if (!model_.fixed.empty()) {
      model_.fixed = gather_column(exec, model_.fixed, 1, model_.source_row);
    }
    if (setup.contour.views == ContourViews::kAll) {
      views_.resize(setup.problem.scene.views.size());
      std::iota(views_.begin(), views_.end(), std::size_t(0));
    }
    std::erase_if(views_, [&](std::size_t v) { return hides_object(setup.problem, v); });
  }

  /// Refines the masks of the current model. False: no mask to train on or, in the first iteration, the given masks
  /// reject the refinement.
  bool refine(bool first) {
    const auto timed = monitor_.scope("refine contours");
    refined_ = refined_in(views_, detail_, first);
    if (first && could_enlarge(refined_, kLargeDetail)) try_enlarging();
    if (first)
      std::copy_if(views_.begin(), views_.end(), std::back_inserter(photoless_),
                   [&](std::size_t v) { return refined_[v].detail == 0; });
    drop_empty_views();
    if (!first || views_.empty()) return !views_.empty();
    return agrees_with_masks();
  }

  /// True: the given masks' contours do not lie on the edges found by the last refinement.
  bool misaligned() const { return masks_misaligned(refined_); }

  /// True: a trial must decide what views without a photo are trained on, and enough views have a photo. Selects the
  /// trial views. Call after the first refinement.
  bool needs_trial() {
    if (setup_.contour.photoless == PhotolessViews::kAuto && !photoless_.empty()) trial_views_ = trial_views_of(views_);
    return !trial_views_.empty();
  }

  /// Runs the trial: the first of `iterations` without the trial views, whose result is discarded. False: the iteration
  /// ended early and its result is kept.
  bool run_trial(int iterations) {
    ContourModel start = model_;
    std::erase_if(views_, [&](std::size_t v) {
      return std::find(trial_views_.begin(), trial_views_.end(), v) != trial_views_.end();
    });
    if (!train(0, iterations)) return false;
    const auto timed = monitor_.scope("photoless trial");
    trial_ = evaluate_trial(exec_, refine_setup(detail_), {{start.cloud, start.labels}, {model_.cloud, model_.labels}},
                            refined_, trial_views_);
    model_ = std::move(start);
    iterations_ = 0;
    add_views(trial_views_);
    return true;
  }

  /// Replaces the photos of views without one by renderings of the current model, if an option or the trial decides so.
  /// Call before the first iteration.
  void add_renderings() {
    const bool wanted = setup_.contour.photoless == PhotolessViews::kPicture || (trial_ && trial_->renderings_help);
    if (photoless_.empty() || !wanted) return;
    rendered_problem_.emplace(with_renderings(exec_, setup_.problem, model_.cloud, photoless_));
    std::vector<RefinedView> more =
        refine_views(exec_, refine_setup(detail_), {model_.cloud, model_.labels}, photoless_, {});
    for (const std::size_t v : photoless_) refined_[v] = std::move(more[v]);
    add_views(photoless_);
    drop_empty_views();
  }

  /// Trains one of `iterations`, the last one at full size. False: it ended early.
  bool train(int iteration, int iterations) {
    Scene scene = setup_.problem.scene;
    for (const std::size_t v : views_) scene.views[v].camera = window_camera(scene.views[v].camera, refined_[v].window);
    const IterationRows rows = split_model(exec_, setup_, window_input(scene, iteration, model_.cloud), model_);
    if (monitor_.stop_requested()) return false;
    const GaussianCloud part = gather_rows(exec_, model_.cloud, rows.rows);
    Problem input = window_input(scene, iteration, part);
    input.labels = gather_labels(exec_, model_.labels, rows.rows);
    input.region = rows_with_foreground_evidence(input.labels);
    for (std::size_t r = 0; r < rows.frozen.size(); ++r) input.region[r] |= !rows.frozen[r];
    if (!model_.fixed.empty()) input.fixed = gather_column(exec_, model_.fixed, 1, rows.rows);
    const bool early = iteration + 1 < iterations && !setup_.contour.on.full_resolution;
    const JointOptions joint = window_options(setup_, views_.size(), early);
    GaussianRates rates = kContourRates;
    std::optional<CoarseInput> coarse;
    if (early) {
      coarse.emplace(input, kCoarseShrink, 0);  // no cache: the trainer has its own
      rates.sh_rest = 0;                        // a tenth of a step; the last iteration trains these bands
    }
    JointTrainer trainer(exec_, monitor_,
                         {joint, setup_.training.sample, setup_.training.rbf, coarse ? coarse->get() : input, nullptr,
                          rates, rows.frozen, setup_.training.losses},
                         true);
    const auto whole = [&] {
      write_back(exec_, trainer.result(), rows.rows, model_);
      return Solution{.cloud = unchanged(model_.cloud), .source_row = model_.source_row, .labels = model_.labels};
    };
    bool ended = false;
    while (!trainer.finished() && !ended && !monitor_.stop_requested()) {
      const JointProgress progress = trainer.step();
      monitor_.progress(progress.step, progress.steps);
      ended = setup_.stop_after && setup_.stop_after(progress, trainer, whole);
    }
    write_back(exec_, trainer.result(), rows.rows, model_);
    ++iterations_;
    return trainer.finished() && !ended;
  }

  void finish(Solution& result) && {
    result.figures["contour_iterations"] = double(iterations_);
    result.figures["contour_biou_rendered"] = rendered_;
    result.figures["contour_biou_refined"] = refined_biou_;
    result.figures["contour_contrast_given"] = own_contrast_;
    result.figures["contour_contrast_refined"] = refined_contrast_;
    result.figures["contour_contrast_rendered"] = rendered_contrast_;
    result.figures["contour_detail"] = double(detail_);
    result.figures["contour_pictures"] =
        rendered_problem_ ? double(std::count_if(photoless_.begin(), photoless_.end(),
                                                 [&](std::size_t v) { return refined_[v].masks.available(); }))
                          : 0.0;
    if (trial_) {
      result.figures["contour_biou_pictured"] = trial_->pictured;
      result.figures["contour_biou_skipped"] = trial_->skipped;
    }
    result.figures["contour_gaussians"] = double(model_.cloud.size());
    if (iterations_ == 0) return;
    result.cloud = std::make_shared<const GaussianCloud>(std::move(model_.cloud));
    result.labels = std::move(model_.labels);
    result.source_row = std::move(model_.source_row);
  }

 private:
  std::vector<RefinedView> refined_in(const std::vector<std::size_t>& views, int detail, bool compare) const {
    return refine_views(exec_, refine_setup(detail), {model_.cloud, model_.labels}, views,
                        compare ? setup_.problem.views : std::vector<std::size_t>{});
  }

  RefineSetup refine_setup(int detail) const {
    return {setup_.contour.refine, setup_.contour.margin_px, input(), detail};
  }

  const Problem& input() const { return rendered_problem_ ? *rendered_problem_ : setup_.problem; }

  void add_views(const std::vector<std::size_t>& more) {
    views_.insert(views_.end(), more.begin(), more.end());
    std::sort(views_.begin(), views_.end());
  }

  void drop_empty_views() {
    std::erase_if(views_, [&](std::size_t v) { return !refined_[v].masks.available(); });
  }

  /// Switches to enlarged photos if contours refined in them agree better with the given masks. A few views decide
  /// first whether the others are tried.
  void try_enlarging() {
    constexpr std::size_t kFirstViews = 8;
    std::vector<std::size_t> compared, rest;
    std::ranges::copy_if(views_, std::back_inserter(compared), [&](std::size_t v) { return refined_[v].compared; });
    const std::vector<std::size_t> few = spread_views(compared, kFirstViews);
    std::vector<RefinedView> large = refined_in(few, kLargeDetail, true);
    if (gain_in_standard_errors(gains_over(large, refined_)) <= kSignificant / 2) return;
    std::ranges::set_difference(views_, few, std::back_inserter(rest));
    std::vector<RefinedView> more = refined_in(rest, kLargeDetail, true);
    for (const std::size_t v : rest) large[v] = std::move(more[v]);
    if (gain_in_standard_errors(gains_over(large, refined_)) <= kSignificant) return;
    detail_ = kLargeDetail;
    refined_ = std::move(large);
  }

  /// False: the given masks reject the refined contours (paper.md §5.10). Sets the figures of agreement and contrast.
  bool agrees_with_masks() {
    double count = 0;
    for (const RefinedView& view : refined_) {
      if (!view.compared) continue;
      ++count;
      rendered_ += view.rendered_biou;
      refined_biou_ += view.refined_biou;
      own_contrast_ += view.own_contrast;
      refined_contrast_ += view.refined_contrast;
      rendered_contrast_ += view.rendered_contrast;
    }
    if (count == 0) count = 1;
    for (double* sum : {&rendered_, &refined_biou_, &own_contrast_, &refined_contrast_, &rendered_contrast_})
      *sum /= count;
    return !masks_reject(exec_, refine_setup(detail_), {model_.cloud, model_.labels}, refined_);
  }

  /// The problem of the windows, without labels. `scene` has the windows' cameras.
  Problem window_input(const Scene& scene, int iteration, const GaussianCloud& cloud) const {
    return {.cloud = cloud,
            .scene = scene,
            .views = views_,
            .load_masks = [this](std::size_t v) { return refined_[v].masks.unpacked(); },
            .load_photo = [this](std::size_t v) { return window_photo(v); },
            .splat = setup_.problem.splat,
            .background = setup_.problem.background,
            .seed = setup_.problem.seed + std::uint64_t(iteration),
            .monitor = &monitor_};
  }

  ImageF window_photo(std::size_t v) const {
    const ImageF photo = input().load_photo(v);
    ImageF out(refined_[v].window.w, refined_[v].window.h, photo.channels);
    out.data = cropped(photo.data, photo.width_px, photo.channels, refined_[v].window);
    return out;
  }

  const Exec& exec_;
  Monitor& monitor_;
  const ContourSetup& setup_;
  ContourModel model_;
  std::vector<std::size_t> views_;                    // trained views: with a photo that shows the object
  std::vector<std::size_t> photoless_, trial_views_;  // views without a photo; trial views
  std::vector<RefinedView> refined_;                  // [scene views]
  std::optional<Problem> rendered_problem_;           // the problem with renderings for photoless_; nullopt: not used
  std::optional<Trial> trial_;                        // result of the completed trial
  double rendered_ = 0, refined_biou_ = 0, own_contrast_ = 0, refined_contrast_ = 0, rendered_contrast_ = 0;
  int iterations_ = 0, detail_ = 1;
};

}  // namespace

Solution refine_contours(const Exec& exec, Monitor& monitor, const ContourSetup& setup, Solution start) {
  if (!setup.problem.load_fine_photo) return start;
  if (setup.half_size) {
    const HalfSize half(setup.problem);
    return refine_contours(exec, monitor, {setup.contour, setup.training, half.get(), setup.stop_after, setup.planned},
                           std::move(start));
  }
  const auto timed = monitor.scope("contours");
  ContourRun run(exec, monitor, setup, start);
  const bool more = setup.contour.on.iterations;
  int iterations = 1;
  for (int iteration = 0; iteration < iterations && start.converged && !monitor.stop_requested(); ++iteration) {
    if (!run.refine(iteration == 0)) break;
    if (iteration == 0) {
      if (more) iterations = contour_iterations(setup.contour, setup.training.joint.quality, run.misaligned());
      const bool trial = run.needs_trial();
      if (setup.planned) setup.planned(iterations + trial);  // a trial takes as long as an iteration
      if (trial && !(start.converged = run.run_trial(iterations))) break;
      run.add_renderings();
    }
    start.converged = run.train(iteration, iterations);
  }
  std::move(run).finish(start);
  return start;
}

}  // namespace ngs
