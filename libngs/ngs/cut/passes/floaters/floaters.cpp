#include "ngs/cut/passes/floaters/floaters.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "ngs/cut/evidence/leave_one_out.h"
#include "ngs/cut/evidence/method_labels.h"
#include "ngs/math/median.h"
#include "ngs/ops/neighbours/knn.h"
#include "ngs/ops/optim/resident.h"
#include "ngs/ops/splat/front_layer.h"
#include "ngs/problem/object_core.h"
#include "ngs/problem/view_list.h"
#include "ngs/scene/mask_threshold.h"

namespace ngs {
namespace {

constexpr std::size_t kScoredViews = 8;  // views for the mean PSNR in the figures
constexpr std::size_t kFrontViews = 32;  // views for front_opacity()

/// [N] 1: usable, neither in the core nor near it, and not fixed by hand.
std::vector<std::uint8_t> candidates_of(const Exec& exec, const Problem& input, const ObjectCore& core, double margin) {
  const auto n = std::size_t(input.cloud.size());
  const std::vector<float> centres = core_centres(input.cloud, core);
  std::vector<std::uint8_t> candidate(n);
  for (std::size_t i = 0; i < n; ++i) candidate[i] = !core.member[i] && input.cloud.usable[i] && !is_fixed(input, i);
  const std::vector<std::uint8_t> near = any_within(
      exec, {centres.data(), core.count}, {input.cloud.position.data(), input.cloud.size()}, margin, candidate);
  for (std::size_t i = 0; i < n; ++i) candidate[i] &= !near[i];
  return candidate;
}

/// The rendering of the core alone from one camera.
struct Surface {
  ImageF colour;  // [H, W, 3] valid at pixels with a surface
  ImageF limit;   // [H, W, 1] camera z; nearer Gaussians are in front of the surface; 0: no surface

  double pixels() const {
    return double(std::count_if(limit.data.begin(), limit.data.end(), [](float z) { return z > 0; }));
  }
};

/// The surface at the pixels where `alone` has at least the opacity `surface_alpha`.
Surface surface_of(RenderedView alone, double surface_alpha, double margin) {
  Surface s{std::move(alone.colour), ImageF(alone.width_px, alone.height_px, 1)};
  for (std::size_t p = 0; p < alone.alpha.data.size(); ++p) {
    const double alpha = double(alone.alpha.data[p]);
    if (alpha < surface_alpha) continue;
    s.limit.data[p] = float(double(alone.depth.data[p]) / alpha - margin);
    for (std::size_t c = 0; c < 3; ++c) s.colour.data[3 * p + c] /= float(alpha);
  }
  return s;
}

double difference(const float* a, const float* b) {
  double sum = 0;
  for (int c = 0; c < 3; ++c) sum += std::abs(double(a[c]) - double(b[c]));
  return sum / 3;
}

/// The photo's colour channels as three soft masks. A Gaussian's evidence is then its mean photo colour.
ViewMasks colours_as_masks(const ImageF& photo) {
  ViewMasks channels;
  channels.width_px = photo.width_px;
  channels.height_px = photo.height_px;
  channels.available = true;
  channels.target.assign(3, std::vector<float>(std::size_t(photo.pixels())));
  for (std::size_t p = 0; p < std::size_t(photo.pixels()); ++p)
    for (std::size_t c = 0; c < 3; ++c) channels.target[c][p] = photo.data[3 * p + c];
  return channels;
}

class FloaterSearch {
 public:
  FloaterSearch(const Exec& exec, const FloaterOptions& options, const Problem& input)
      : exec_(exec),
        options_(options),
        input_(input),
        splat_(input.splat),
        core_(core_of(options.core, input.cloud, input.labels)),
        resident_(exec),
        views_(spread_views(photo_views(input.scene), options.max_views)),
        trained_(input.scene.views.size(), 0) {
    for (const std::size_t v : input.views) trained_[v] = 1;
    resident_.add_input(core_.member);
    prepare();
  }

  FloaterFinding run(Monitor& monitor) {
    FloaterFinding finding;
    finding.floater.assign(std::size_t(cloud().size()), 0);
    if (core_.count == 0 || views_.empty()) return finding;
    margin_ = core_margin(exec_, options_.core, cloud(), core_);
    finding.far = candidate_ = candidates_of(exec_, input_, core_, margin_);
    const auto candidates = std::count(candidate_.begin(), candidate_.end(), std::uint8_t(1));
    finding.figures = {{"core", double(core_.count)}, {"candidates", double(candidates)}, {"margin", margin_}};
    noise_ = core_noise();
    int rounds = 0;
    while (rounds < options_.rounds && !monitor.stop_requested()) {
      const auto timed = monitor.scope("floaters: search");
      ++rounds;
      const std::vector<std::size_t> found = round();
      if (rounds == 1) finding.figures["hidden"] = hidden_;
      if (found.empty() || (rounds == 1 && hidden_ < options_.min_hidden)) break;
      for (const std::size_t i : found) {
        finding.floater[i] = 1;
        candidate_[i] = 0;
      }
      remove(found);
      finding.count += std::int64_t(found.size());
    }
    finding.figures["rounds"] = rounds;
    finding.figures["noise"] = noise_;
    return finding;
  }

  double front_opacity() {
    if (core_.count == 0) return 0;
    margin_ = core_margin(exec_, options_.core, cloud(), core_);
    candidate_ = candidates_of(exec_, input_, core_, margin_);
    double sum = 0, pixels = 0;
    Resident flags(exec_);
    flags.add_input(candidate_);
    for_each_view(input_.monitor, spread_views(views_, kFrontViews), [&](std::size_t, std::size_t v) {
      const Surface s = surface(v);
      if (s.pixels() == 0) return;
      const ImageF layer = front_view(v, s).layer(candidate_);
      for (std::size_t p = 0; p < s.limit.data.size(); ++p)
        if (s.limit.data[p] > 0) {
          sum += double(layer.data[p]);
          ++pixels;
        }
    });
    return pixels > 0 ? sum / pixels : 0;
  }

 private:
  const Camera& camera(std::size_t v) const { return input_.scene.views[v].camera; }
  /// The cloud without the floaters of earlier rounds.
  const GaussianCloud& cloud() const { return remaining_ ? *remaining_ : input_.cloud; }

  void remove(const std::vector<std::size_t>& rows) {
    if (!remaining_) remaining_.emplace(input_.cloud);
    for (const std::size_t i : rows) remaining_->logit_opacity[i] = kRemovedLogit;
    splat_.prepared = nullptr;  // the opacities changed
    prepare();
  }
  void prepare() { splat_ = prepared_for(exec_, splat_, cloud()); }

  /// The Gaussians in front of the core's surface, in view `v`.
  FrontView front_view(std::size_t v, const Surface& surface) const {
    return {exec_, cloud(), surface.limit, camera(v), splat_};
  }

  /// The core is the same in all rounds, so its surfaces are cached, up to 256 MiB.
  Surface surface(std::size_t v) {
    const auto known = surfaces_.find(v);
    if (known != surfaces_.end()) return known->second;
    constexpr std::size_t kCacheBytes = 256u << 20;
    RenderRequest request;
    request.depth = true;
    request.include = core_.member.data();
    Surface s = surface_of(render(exec_, cloud(), camera(v), splat_, request), options_.surface_alpha, margin_);
    const std::size_t bytes = std::size_t(s.limit.pixels()) * 4 * sizeof(float);
    if ((surfaces_.size() + 1) * bytes <= kCacheBytes) surfaces_[v] = s;
    return s;
  }

  /// Median over the views of the median difference between core and photo.
  double core_noise() {
    std::vector<double> medians;
    for_each_view(input_.monitor, views_, [&](std::size_t, std::size_t v) {
      const Surface s = surface(v);
      const ImageF photo = input_.load_photo(v);
      std::vector<double> all;
      for (std::size_t p = 0; p < s.limit.data.size(); ++p)
        if (s.limit.data[p] > 0) all.push_back(difference(&photo.data[3 * p], &s.colour.data[3 * p]));
      if (!all.empty()) medians.push_back(upper_median(all));
    });
    return medians.empty() ? 1.0 : upper_median(medians);
  }

  /// Mean photo colour of each candidate over some views, followed by a 1; zeros if those views do not show it.
  struct MeanColours {
    std::vector<float> value;  // [candidates, 4]

    void set(std::size_t number, const LeaveOneOut::Shares& shares) {
      std::copy_n(shares.share, 3, &value[4 * number]);
      value[4 * number + 3] = float(shares.seen);
    }
  };

  /// [H, W] 1: the photo shows the surface although the model has Gaussians in front of it.
  std::vector<std::uint8_t> sees_past(std::size_t v, const Surface& s, const ImageF& photo, const ImageF& front) const {
    ViewMasks masks;
    if (trained_[v]) masks = input_.load_masks(v);
    std::vector<std::uint8_t> marked(s.limit.data.size(), 0);
    const double least = options_.noise_factor * noise_;
    for (std::size_t p = 0; p < marked.size(); ++p) {
      const float* f = &front.data[5 * p];
      if (!(s.limit.data[p] > 0) || !(f[4] > 0) || vetoed(masks, p)) continue;
      const double to_surface = difference(&photo.data[3 * p], &s.colour.data[3 * p]);
      if (f[3] >= 0.5f * f[4]) {
        const float elsewhere[3] = {f[0] / f[3], f[1] / f[3], f[2] / f[3]};
        marked[p] = difference(&photo.data[3 * p], elsewhere) - to_surface > least;
      } else {
        marked[p] = to_surface < least;
      }
    }
    return marked;
  }
  /// True: the view's masks are known at the pixel and label it background.
  static bool vetoed(const ViewMasks& masks, std::size_t p) {
    if (!masks.available || (!masks.known.empty() && !masks.known[p])) return false;
    return std::all_of(masks.target.begin(), masks.target.end(),
                       [&](const std::vector<float>& target) { return !mask_is_foreground(target[p]); });
  }

  /// [N] 1: candidates that lie in front of the surface in some view. Returns all candidates if the core is a large
  /// part of the model, because the test would take longer than it saves.
  std::vector<std::uint8_t> candidates_in_front() {
    constexpr std::int64_t kMinCoresPerModel = 8;  // minimum size of the model, in sizes of the core
    if (kMinCoresPerModel * std::int64_t(core_.count) >= cloud().size()) return candidate_;
    std::vector<std::uint8_t> in_front(candidate_.size(), 0);
    Resident flags(exec_);
    flags.add_input(candidate_);
    for_each_view(input_.monitor, views_, [&](std::size_t, std::size_t v) {
      const Surface s = surface(v);
      if (s.pixels() == 0) return;
      const std::vector<std::uint8_t> none(s.limit.data.size(), 0);
      for (const std::uint32_t row : front_view(v, s).sums(candidate_, none).row) in_front[row] = 1;
    });
    return in_front;
  }

  /// Finds the rows of this round's floaters. Sets hidden_.
  std::vector<std::size_t> round() {
    const RowNumbers front_rows(candidates_in_front());
    Resident flags(exec_);
    flags.add_input(front_rows.chosen);
    flags.add_input(front_rows.number);
    const auto n = std::size_t(front_rows.size());
    const auto weights = [&](std::size_t v) {
      const ViewMasks channels = colours_as_masks(input_.load_photo(v));
      return packed_sums(exec_, cloud(), {camera(v), channels}, splat_, &front_rows);
    };
    LeaveOneOut colours(exec_, front_rows.size(), 3, weights);
    if (!for_each_view(input_.monitor, views_, [&](std::size_t, std::size_t v) { colours.add(v); })) return {};
    MeanColours elsewhere{std::vector<float>(4 * n)};
    colours.for_all([&](std::size_t i, const LeaveOneOut::Shares& all) { elsewhere.set(i, all); });
    std::vector<double> front(n), through(n), reach(n), own(n);
    double surface_px = 0;
    for_each_view(input_.monitor, views_, [&](std::size_t, std::size_t v) {
      const Surface s = surface(v);
      if (s.pixels() == 0) return;
      surface_px += s.pixels();
      const ImageF photo = input_.load_photo(v);
      const std::shared_ptr<const PackedSums> shown = colours.weights_of(v);
      colours.for_others_in(*shown, [&](std::size_t i, const LeaveOneOut::Shares& others, double weight) {
        elsewhere.set(i, others);
        own[i] = weight;
      });
      const FrontView view = front_view(v, s);
      const ImageF layer = view.layer({front_rows, {elsewhere.value.data(), front_rows.size(), 4}});
      const ViewSums sums = view.sums(front_rows.chosen, sees_past(v, s, photo, layer));
      for (std::size_t k = 0; k < sums.size(); ++k) {
        const std::size_t i = front_rows.number[sums.row[k]];
        front[i] += sums.weight(k);
        through[i] += sums.object_weight(k, 0);
        if (own[i] > 0) reach[i] = std::max(reach[i], sums.weight(k) / own[i]);
      }
      colours.for_all_in(*shown, [&](std::size_t i, const LeaveOneOut::Shares& all) {
        elsewhere.set(i, all);
        own[i] = 0;
      });
    });
    if (stop_requested(input_.monitor)) return {};
    std::vector<std::size_t> found;
    double hidden_px = 0;
    for (std::size_t i = 0; i < n; ++i) {
      if (!(front[i] > 0) || reach[i] < options_.min_reach || through[i] < options_.sees_past * front[i]) continue;
      found.push_back(std::size_t(front_rows.row[i]));
      hidden_px += through[i];
    }
    hidden_ = surface_px > 0 ? hidden_px / surface_px : 0;
    return found;
  }

  const Exec& exec_;
  const FloaterOptions& options_;
  const Problem& input_;
  std::optional<GaussianCloud> remaining_;  // the cloud without earlier floaters; nullopt: none found yet
  SplatOptions splat_;                      // prepared for cloud()
  ObjectCore core_;
  Resident resident_;  // the core's members
  std::vector<std::size_t> views_;
  std::vector<std::uint8_t> trained_;  // [views of the scene]
  std::vector<std::uint8_t> candidate_;
  std::map<std::size_t, Surface> surfaces_;  // by view
  double margin_ = 0, noise_ = 0, hidden_ = 0;
};

}  // namespace

double front_opacity(const Exec& exec, const FloaterOptions& options, const Problem& input) {
  return FloaterSearch(exec, options, input).front_opacity();
}

FloaterFinding find_floaters(const Exec& exec, Monitor& monitor, const FloaterOptions& options, const Problem& input) {
  return FloaterSearch(exec, options, input).run(monitor);
}

namespace {

/// [N] 1: Gaussians that become visible at pixels where floaters were rendered.
std::vector<std::uint8_t> uncovered_rows(const Exec& exec, const Problem& input, const std::vector<std::size_t>& views,
                                         const std::vector<std::uint8_t>& floater, const GaussianCloud& without) {
  constexpr float kDrawn = 1.f / 255;
  const std::vector<float> label(floater.begin(), floater.end());
  const SplatOptions with = prepared_for(exec, input.splat, input.cloud),
                     splat = prepared_for(exec, input.splat, without);
  Resident resident(exec);
  resident.add_input(label);
  std::vector<std::uint8_t> uncovered(floater.size(), 0);
  for_each_view(input.monitor, views, [&](std::size_t, std::size_t v) {
    const Camera& camera = input.scene.views[v].camera;
    RenderRequest request{.colour = false, .label = {label.data(), std::int64_t(label.size()), 1}};
    request.tiles_touching = request.stop_after = floater.data();
    ViewMasks covered = known_view(camera);
    covered.target.push_back(std::move(render(exec, input.cloud, camera, with, request).label.data));
    for (float& pixel : covered.target[0]) pixel = float(pixel >= kDrawn);
    const ViewSums sums = view_sums(exec, without, {camera, covered}, splat);
    for (std::size_t i = 0; i < sums.size(); ++i) uncovered[sums.row[i]] |= sums.object_weight(i, 0) > 0;
  });
  return uncovered;
}

}  // namespace

FloaterRemoval remove_floaters(const Exec& exec, Monitor& monitor, const RefitOptions& refit, const Problem& input,
                               const FloaterFinding& finding) {
  const std::vector<std::uint8_t>& floater = finding.floater;
  FloaterRemoval out{input.cloud, {}};
  const auto timed = monitor.scope("floaters: removal");
  const std::vector<std::size_t> views = photo_views(input.scene);
  for (std::size_t i = 0; i < floater.size(); ++i)
    if (floater[i]) out.cloud.logit_opacity[i] = kRemovedLogit;
  const std::vector<std::size_t> scored = spread_views(views, kScoredViews);
  out.figures["psnr_before_db"] = mean_psnr_db(exec, input, input.cloud, scored);
  out.figures["psnr_removed_db"] = mean_psnr_db(exec, input, out.cloud, scored);
  const std::vector<std::uint8_t> uncovered = uncovered_rows(exec, input, views, floater, out.cloud);
  out.figures["uncovered"] = double(std::ranges::count(uncovered, std::uint8_t(1)));
  refit_to_photos(exec, monitor, refit, {input, views, finding.far, uncovered}, out.cloud);
  out.figures["psnr_after_db"] = mean_psnr_db(exec, input, out.cloud, scored);
  return out;
}

std::vector<LabelColumns> labels_without_floaters(const Exec& exec, Monitor& monitor, const Problem& input,
                                                  const GaussianCloud& cloud,
                                                  const std::vector<std::uint8_t>& floater) {
  std::vector<LabelColumns> labels = recompute_labels(exec, monitor, input, cloud);
  for (std::size_t k = 0; k < labels.size(); ++k)
    for (std::size_t i = 0; i < floater.size(); ++i)
      if (floater[i]) {
        LabelColumns& c = labels[k];
        c.label[i] = c.prob[i] = c.variance[i] = c.boundary[i] = 0;
        c.views[i] = input.labels[k].views[i];
      }
  return labels;
}

}  // namespace ngs
