#include "ngs/stages/edge_stage.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "ngs/backend/try_each.h"
#include "ngs/ops/evidence.h"
#include "ngs/stages/edge_split.h"
#include "ngs/stages/render_stage.h"
#include "ngs/stages/variance_stage.h"

namespace ngs {
namespace {

/// As fast as the mask and photo losses still fall on every round: positions at 3DGS's first rate, shapes
/// above its rates, opacities below (they are what the colours of other views rest on).
constexpr GaussianRates kEdgeRates{.position = 1.6e-4,
                                   .rotation = 5e-2,
                                   .log_scale = 1e-1,
                                   .logit_opacity = 7.5e-2,
                                   .sh_dc = 2.5e-2,
                                   .sh_rest = 1.25e-3};

// Which Gaussians are trained: share of the weight in the windows, weight across contours, share of the
// object.
constexpr double kLeastInside = 0.99, kLeastStraddling_px = 0.5, kLeastObject = 0.05;

int visits_of(const EdgeOptions& edge, Quality quality) {
  if (edge.visits > 0) return edge.visits;
  return quality == Quality::kReference  ? 100
         : quality == Quality::kHigh     ? 40
         : quality == Quality::kStandard ? 15
                                         : 0;
}

struct PixelWindow {
  int x0 = 0, y0 = 0, w = 0, h = 0;
};

/// What a round trains a view on: the window and, in it, the walked masks.
struct WalkedView {
  PixelWindow window;
  ViewMasks masks;  // of the window's size
  // Mean boundary IoU with the view's own masks; only where the view supervises and has them.
  bool compared = false;
  double rendered_biou = 0, walked_biou = 0;
};

/// Mean over the area of every coarse pixel; sides of any ratio.
std::vector<float> reduce(const std::vector<float>& fine, int fw, int fh, int w, int h) {
  std::vector<float> rows(std::size_t(w) * std::size_t(fh)), out(std::size_t(w) * std::size_t(h));
  const auto along = [](int n, int coarse, const auto& from, const auto& to) {
    const double step = double(n) / coarse;
    for (int i = 0; i < coarse; ++i) {
      const double lo = i * step, hi = (i + 1) * step;
      double sum = 0;
      for (int j = int(lo); j < std::min(n, int(std::ceil(hi))); ++j)
        sum += from(j) * (std::min(hi, j + 1.0) - std::max(lo, double(j)));
      to(i, float(sum / step));
    }
  };
  for (int y = 0; y < fh; ++y)
    along(
        fw, w, [&](int x) { return double(fine[std::size_t(y) * std::size_t(fw) + std::size_t(x)]); },
        [&](int x, float v) { rows[std::size_t(y) * std::size_t(w) + std::size_t(x)] = v; });
  for (int x = 0; x < w; ++x)
    along(
        fh, h, [&](int y) { return double(rows[std::size_t(y) * std::size_t(w) + std::size_t(x)]); },
        [&](int y, float v) { out[std::size_t(y) * std::size_t(w) + std::size_t(x)] = v; });
  return out;
}

template <class T>
std::vector<T> cropped(const std::vector<T>& plane, int width_px, int channels, const PixelWindow& win) {
  std::vector<T> out;
  out.reserve(std::size_t(win.w) * std::size_t(win.h) * std::size_t(channels));
  for (int y = win.y0; y < win.y0 + win.h; ++y) {
    const auto row = plane.begin() + (std::ptrdiff_t(y) * width_px + win.x0) * channels;
    out.insert(out.end(), row, row + std::ptrdiff_t(win.w) * channels);
  }
  return out;
}

/// The pixels where any target exceeds 0, and a margin; empty where there are none.
PixelWindow window_of(const std::vector<std::vector<float>>& targets, int w, int h, int margin) {
  int x0 = w, x1 = -1, y0 = h, y1 = -1;
  for (const std::vector<float>& target : targets)
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x)
        if (target[std::size_t(y) * std::size_t(w) + std::size_t(x)] > 0.f)
          x0 = std::min(x0, x), x1 = std::max(x1, x), y0 = std::min(y0, y), y1 = std::max(y1, y);
  if (x1 < 0) return {};
  x0 = std::max(0, x0 - margin), y0 = std::max(0, y0 - margin);
  return {x0, y0, std::min(w, x1 + 1 + margin) - x0, std::min(h, y1 + 1 + margin) - y0};
}

Camera window_camera(Camera camera, const PixelWindow& win) {
  camera.cx -= win.x0, camera.cy -= win.y0;
  camera.width_px = win.w, camera.height_px = win.h;
  return camera;
}

/// The model on its way through the rounds.
struct Model {
  GaussianCloud cloud;
  std::vector<LabelColumns> labels;
  std::vector<std::int64_t> source_row;
  std::vector<float> fixed;
};

/// Agreement of a mask at the camera's size with the view's own, over the pixels that are known.
double agreement(const std::vector<float>& mask, const ViewMasks& own, std::size_t k) {
  std::vector<std::uint8_t> a(mask.size()), b(mask.size());
  for (std::size_t p = 0; p < mask.size(); ++p) {
    const bool known = own.known.empty() || own.known[p];
    a[p] = known && mask[p] >= 0.5f, b[p] = known && own.target[k][p] >= 0.5f;
  }
  Exec serial;
  const int w = own.width_px, h = own.height_px;
  return boundary_iou(serial, chessboard_distance({a.data(), w, h}), chessboard_distance({b.data(), w, h}), w,
                      band_width_px(0.005, w, h));
}

WalkedView walk_view(const EdgeSetup& setup, const Model& model, std::size_t v, bool compare) {
  const Exec serial;
  const MethodInput& input = setup.input;
  const Camera& camera = input.scene.views[v].camera;
  const ImageF photo = input.load_fine_photo(v);
  if (photo.empty()) return {};
  const int fw = photo.width_px, fh = photo.height_px, w = camera.width_px, h = camera.height_px;
  const RenderedView rendered =
      render_labelled(serial, model.cloud, model.labels, resized(camera, fw, fh),
                      filter_at_scale(input.splat, double(fw) / w), input.background, false);
  const ViewMasks own = compare ? input.load_masks(v) : ViewMasks{};
  const std::size_t objects = model.labels.size();
  WalkedView out;
  out.compared = own.available;
  std::vector<std::vector<float>> targets(objects);
  for (std::size_t k = 0; k < objects; ++k) {
    std::vector<std::uint8_t> mask(std::size_t(photo.pixels()));
    for (std::size_t p = 0; p < mask.size(); ++p) mask[p] = rendered.label.data[p * objects + k] > 0.5f;
    std::vector<float> walked = walk_to_edges(setup.edge.walk, {mask.data(), fw, fh}, photo);
    for (float& x : walked) x = x > 0.5f ? 1.f : 0.f;
    targets[k] = reduce(walked, fw, fh, w, h);
    if (!out.compared) continue;
    out.rendered_biou +=
        agreement(reduce({mask.begin(), mask.end()}, fw, fh, w, h), own, k) / double(objects);
    out.walked_biou += agreement(targets[k], own, k) / double(objects);
  }
  out.window = window_of(targets, w, h, int(std::lround(setup.edge.margin_px)));
  out.masks.width_px = out.window.w, out.masks.height_px = out.window.h;
  out.masks.available = out.window.w > 0;
  for (const auto& target : targets) out.masks.target.push_back(cropped(target, w, 1, out.window));
  return out;
}

/// Weight of every Gaussian in the views' pictures, [N].
std::vector<double> weight_in(const Exec& exec, const GaussianCloud& cloud, const Scene& scene,
                              const std::vector<std::size_t>& views, const SplatOptions& splat) {
  Evidence seen(cloud.size(), 1);
  for (const std::size_t v : views) {
    const Camera& camera = scene.views[v].camera;
    ViewMasks all;
    all.width_px = camera.width_px, all.height_px = camera.height_px, all.available = true;
    all.target.emplace_back(std::size_t(camera.width_px) * std::size_t(camera.height_px), 1.f);
    add_view_evidence(exec, cloud, camera, splat, all, seen);
  }
  std::vector<double> weight(std::size_t(cloud.size()));
  for (std::size_t i = 0; i < weight.size(); ++i) weight[i] = seen.weight.value(i);
  return weight;
}

/// 1: the Gaussian shows outside of the windows too, where no photo would hold it.
std::vector<std::uint8_t> shows_outside(const Exec& exec, const EdgeSetup& setup, const MethodInput& window,
                                        const GaussianCloud& cloud) {
  const std::vector<double> inside = weight_in(exec, cloud, window.scene, window.views, window.splat),
                            all = weight_in(exec, cloud, setup.input.scene, window.views, window.splat);
  std::vector<std::uint8_t> outside(inside.size());
  for (std::size_t i = 0; i < outside.size(); ++i) outside[i] = inside[i] < kLeastInside * all[i];
  return outside;
}

/// Gaussians that are not trained: those, and background that does not lie across a contour.
std::vector<std::uint8_t> unconcerned(const Exec& exec, const EdgeSetup& setup, const MethodInput& window,
                                      const Model& model) {
  std::vector<std::uint8_t> frozen = shows_outside(exec, setup, window, model.cloud);
  const std::vector<double> straddling = straddling_px(exec, window, model.cloud);
  for (std::size_t i = 0; i < frozen.size(); ++i) {
    bool concerned = straddling[i] > kLeastStraddling_px;
    for (const LabelColumns& object : model.labels) concerned |= object.prob[i] > kLeastObject;
    frozen[i] |= !concerned;
  }
  return frozen;
}

/// Halves what lies across a contour. Halves take the closed form of their own evidence, the others keep
/// theirs.
void split_model(const Exec& exec, const EdgeSetup& setup, const MethodInput& window, Model& model) {
  std::vector<double> straddling = straddling_px(exec, window, model.cloud);
  const std::vector<std::uint8_t> outside = shows_outside(exec, setup, window, model.cloud);
  for (std::size_t i = 0; i < straddling.size(); ++i)
    if (outside[i]) straddling[i] = 0;  // halves look a little different until they are trained
  const std::vector<CloudRow> rows =
      split_straddlers(straddling, setup.edge.split_px, std::int64_t(straddling.size()));
  edit_rows(exec, rows, setup.input.seed, model.cloud);
  if (!model.fixed.empty()) edit_column(exec, rows, 1, model.fixed);
  for (LabelColumns& c : model.labels)
    for (auto* column : {&c.label, &c.prob, &c.variance, &c.views, &c.boundary})
      edit_column(exec, rows, 1, *column);
  std::vector<std::int64_t> source;
  for (const CloudRow& row : rows) source.push_back(model.source_row[std::size_t(row.source)]);
  model.source_row = std::move(source);

  Evidence seen(model.cloud.size(), int(model.labels.size()));
  for (const std::size_t v : window.views)
    add_view_evidence(exec, model.cloud, window.scene.views[v].camera, window.splat, window.load_masks(v),
                      seen);
  const std::vector<LabelColumns> closed = label_gaussians({}, seen);
  for (std::size_t k = 0; k < model.labels.size(); ++k)
    for (std::size_t i = 0; i < rows.size(); ++i)
      if (rows[i].origin != RowOrigin::kKept && closed[k].views[i] > 0)
        model.labels[k].prob[i] = closed[k].prob[i];
}

JointOptions window_options(const EdgeSetup& setup, std::size_t views) {
  JointOptions joint = setup.joint;
  joint.steps = std::int64_t(visits_of(setup.edge, setup.joint.quality)) * std::int64_t(views);
  joint.rate_scale = setup.edge.rate, joint.rate_literal = false;
  joint.effect.push_back("nerf=off");  // its rays are those of the whole image
  joint.effect.push_back("cont=off");
  return joint;
}

/// The rounds.
class EdgeRun {
 public:
  EdgeRun(const Exec& exec, Monitor& monitor, const EdgeSetup& setup, const MethodResult& start)
      : exec_(exec),
        monitor_(monitor),
        setup_(setup),
        model_{start.cloud, start.labels, start.source_row, setup.input.fixed},
        views_(setup.input.views) {
    if (model_.source_row.empty()) {
      model_.source_row.resize(std::size_t(model_.cloud.size()));
      std::iota(model_.source_row.begin(), model_.source_row.end(), std::int64_t(0));
    }
    if (setup.edge.views == EdgeViews::kAll) {
      views_.resize(setup.input.scene.views.size());
      std::iota(views_.begin(), views_.end(), std::size_t(0));
    }
  }

  /// Masks of the model as it is; false where there is none to train on or, in the first round, where the
  /// walk disagrees with the given masks.
  bool walk(bool first) {
    const auto timed = monitor_.scope("walk");
    const auto& train = setup_.input.views;
    walked_.assign(setup_.input.scene.views.size(), {});
    try_each_task(exec_, std::int64_t(views_.size()), [&](std::int64_t i) {
      const std::size_t v = views_[std::size_t(i)];
      const bool compare = first && std::find(train.begin(), train.end(), v) != train.end();
      walked_[v] = walk_view(setup_, model_, v, compare);
    });
    views_.erase(std::remove_if(views_.begin(), views_.end(),
                                [&](std::size_t v) { return !walked_[v].masks.available; }),
                 views_.end());
    if (!first || views_.empty()) return !views_.empty();
    return agrees_with_masks();
  }

  /// False if it ended early.
  bool train(int round) {
    Scene scene = setup_.input.scene;
    for (const std::size_t v : views_)
      scene.views[v].camera = window_camera(scene.views[v].camera, walked_[v].window);
    MethodInput window{.cloud = model_.cloud,
                       .scene = scene,
                       .views = views_,
                       .load_masks = [&](std::size_t v) { return walked_[v].masks; },
                       .load_photo = [&](std::size_t v) { return window_photo(v); },
                       .splat = setup_.input.splat,
                       .background = setup_.input.background,
                       .seed = setup_.input.seed + std::uint64_t(round),
                       .fixed = {},
                       .labels = {}};
    split_model(exec_, setup_, window, model_);
    window.fixed = model_.fixed, window.labels = model_.labels;
    const JointOptions joint = window_options(setup_, views_.size());
    const std::vector<std::uint8_t> frozen = unconcerned(exec_, setup_, window, model_);
    JointTrainer trainer(exec_, monitor_,
                         {joint, setup_.sample, setup_.rbf, window, nullptr, kEdgeRates, frozen}, true);
    while (!trainer.finished() && !monitor_.stop_requested() &&
           !(setup_.out_of_time && setup_.out_of_time())) {
      const JointProgress progress = trainer.step();
      monitor_.progress(progress.step, progress.steps);
    }
    MethodResult trained = trainer.result();
    model_.cloud = std::move(trained.cloud), model_.labels = std::move(trained.labels);
    ++rounds_;
    return trainer.finished();
  }

  void finish(MethodResult& result) && {
    result.figures["edge_rounds"] = double(rounds_);
    result.figures["edge_biou_rendered"] = rendered_, result.figures["edge_biou_walked"] = walked_biou_;
    result.figures["edge_gaussians"] = double(model_.cloud.size());
    if (rounds_ == 0) return;
    result.cloud = std::move(model_.cloud), result.labels = std::move(model_.labels);
    result.source_row = std::move(model_.source_row);
  }

 private:
  /// Whether the walked masks agree with the given ones at least as well as the rendered masks did, within
  /// twice the standard error of the mean difference over the views: given masks are noisy themselves.
  bool agrees_with_masks() {
    double count = 0, sum = 0, square = 0;
    for (const WalkedView& view : walked_) {
      if (!view.compared) continue;
      const double gain = view.walked_biou - view.rendered_biou;
      ++count, sum += gain, square += gain * gain;
      rendered_ += view.rendered_biou, walked_biou_ += view.walked_biou;
    }
    if (count == 0) return true;
    rendered_ /= count, walked_biou_ /= count;
    const double mean = sum / count, variance = std::max(0.0, square / count - mean * mean);
    return mean + 2 * std::sqrt(variance / count) >= 0;
  }

  ImageF window_photo(std::size_t v) const {
    const ImageF photo = setup_.input.load_photo(v);
    ImageF out(walked_[v].window.w, walked_[v].window.h, photo.channels);
    out.data = cropped(photo.data, photo.width_px, photo.channels, walked_[v].window);
    return out;
  }

  const Exec& exec_;
  Monitor& monitor_;
  const EdgeSetup& setup_;
  Model model_;
  std::vector<std::size_t> views_;  // with a photo, and with something of the object in it
  std::vector<WalkedView> walked_;  // [scene views]
  double rendered_ = 0, walked_biou_ = 0;
  int rounds_ = 0;
};

}  // namespace

MethodResult follow_edges(const Exec& exec, Monitor& monitor, const EdgeSetup& setup, MethodResult start) {
  if (visits_of(setup.edge, setup.joint.quality) == 0 || !setup.input.load_fine_photo) return start;
  const auto timed = monitor.scope("edges");
  EdgeRun run(exec, monitor, setup, start);
  for (int round = 0; round < setup.edge.rounds && start.converged && !monitor.stop_requested(); ++round) {
    if (!run.walk(round == 0)) break;
    start.converged = run.train(round);
  }
  std::move(run).finish(start);
  return start;
}

}  // namespace ngs
