#include "ngs/cut/masks/mask_spread.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "ngs/core/check.h"
#include "ngs/math/elementary.h"
#include "ngs/scene/mask_threshold.h"

namespace ngs {
namespace {

double angle_between(Vec3<double> a, Vec3<double> b) {
  const double scale = std::sqrt(dot(a, a) * dot(b, b));
  return scale > 0 ? std::acos(std::clamp(dot(a, b) / scale, -1.0, 1.0)) : 0;
}

bool is_empty(const PixelMask& mask) { return std::find(mask.begin(), mask.end(), 1) == mask.end(); }

/// Hand-made marks override the segmenter.
void keep_strokes(const ViewPrompt& by_hand, PixelMask& mask) {
  for (std::size_t p = 0; p < mask.size(); ++p)
    if (is_certain(by_hand.hint[p])) mask[p] = is_object(by_hand.hint[p]);
}

class Spreader {
 public:
  Spreader(const Exec& exec, Monitor& monitor, const SpreadOptions& options, const SpreadInput& input)
      : exec_(exec),
        monitor_(monitor),
        options_(options),
        in_(input),
        all_(input.cloud.size(), 1),
        lifted_mask_(input.camera.size()) {}

  void run() {
    start();
    if (monitor_.stop_requested()) return;
    const std::vector<std::size_t> order = view_order(in_.camera, starts_, object_place(in_.cloud, all_).centre);
    for (int pass = 0; pass < options_.passes; ++pass) {
      const auto timed = monitor_.scope("pass " + std::to_string(pass + 1));
      const bool last = pass + 1 == options_.passes;
      std::int64_t count = 0;
      place_ = object_place(in_.cloud, all_);
      for (const std::size_t view : order) {
        if (!last && !supervises(view)) continue;
        const bool is_started = pass == 0 && first_.contains(view);
        const SpreadView result = is_started ? std::move(first_[view]) : segment(view, pass);
        if (monitor_.stop_requested()) return;
        if (last) in_.done(view, result);
        monitor_.progress(++count, std::int64_t(order.size()));
      }
    }
  }

 private:
  bool is_marked(std::size_t view) const { return in_.marked.contains(view); }
  bool supervises(std::size_t view) const { return is_marked(view) || in_.scene.views[view].split == Split::kTrain; }

  void start() {
    const auto timed = monitor_.scope("reference");
    for (const auto& [view, prompt] : in_.marked) {
      if (std::ranges::none_of(prompt.hint, [](PixelHint hint) { return is_object(hint); })) continue;
      start_with(view, prompt);
      if (monitor_.stop_requested()) return;
    }
    if (starts_.empty())
      throw Error(
          ErrorCode::kNothingFound, "the marked views: only background is marked, expected the object too",
          "draw strokes on the object in one of them, or a box around it; where both are, the background counts");
  }

  std::vector<float> opacity(std::size_t view) const {
    RenderRequest request{.colour = false, .label = {}};
    return render(exec_, in_.cloud, in_.camera[view], in_.splat, request).alpha.data;
  }

  void start_with(std::size_t view, ViewPrompt prompt) {
    SpreadView& first = first_[view];
    const std::vector<float> alpha = opacity(view);
    empty_is_background(alpha, prompt);
    first.mask = in_.segment(view, prompt);
    empty_is_background(alpha, first.mask);
    if (monitor_.stop_requested()) return;
    if (is_empty(first.mask))
      throw Error(ErrorCode::kNothingFound,
                  "the marked view " + in_.camera[view].name + ": no pixel was segmented, expected the object",
                  "draw more strokes on the object, or a box around it");
    keep_strokes(in_.marked.at(view), first.mask);
    first.source = MaskSource::kReference;
    first.soft.assign(first.mask.begin(), first.mask.end());
    starts_.push_back(view);
    lift_and_add(view, first.mask);
  }

  ViewSums lift(std::size_t view) const {
    return lift_mask(exec_, in_.cloud, in_.camera[view], in_.splat, lifted_mask_[view]);
  }
  void lift_and_add(std::size_t view, const PixelMask& mask) {
    lifted_mask_[view] = mask;
    all_.add(lift(view));
  }

  int band_px(const Camera& camera, int pass) const {
    const double diagonal = portable_hypot(double(camera.width_px), double(camera.height_px));
    return int(std::lround(std::max(options_.min_band_px, std::ldexp(options_.band * diagonal, -pass))));
  }

  SpreadView segment(std::size_t view, int pass) {
    if (!lifted_mask_[view].empty()) all_.remove(lift(view));
    const PixelMask before = std::exchange(lifted_mask_[view], {});
    const Consensus consensus =
        render_consensus(exec_, {in_.cloud, all_, place_, in_.use_neighbours}, in_.camera[view], in_.splat);
    ViewPrompt prompt = prompt_from(consensus, band_px(in_.camera[view], pass), before);
    if (is_marked(view)) keep_strokes(in_.marked.at(view), prompt);
    empty_is_background(consensus.alpha, prompt);

    SpreadView out;
    for (const float known : consensus.known) out.known += double(known) / double(consensus.known.size());
    out.mask.resize(consensus.object.size());
    for (std::size_t p = 0; p < out.mask.size(); ++p)
      out.mask[p] = label_is_foreground(consensus.object[p]) && is_set(consensus.known[p]);
    if (!is_empty(out.mask) || is_marked(view)) {
      out.source = MaskSource::kRendered;
      if (in_.has_photo[view]) try_segmenter(view, prompt, consensus, out);
    }
    out.soft.resize(out.mask.size());
    for (std::size_t p = 0; p < out.mask.size(); ++p) out.soft[p] = 0.5f * (float(out.mask[p]) + consensus.object[p]);
    return out;
  }

  void try_segmenter(std::size_t view, const ViewPrompt& prompt, const Consensus& consensus, SpreadView& out) {
    PixelMask found = in_.segment(view, prompt);
    empty_is_background(consensus.alpha, found);
    if (is_marked(view)) keep_strokes(in_.marked.at(view), found);
    out.agreement = agreement(consensus, found);
    if (!is_marked(view) && (out.agreement < options_.gate_iou || is_empty(found))) return;
    out.mask = std::move(found);
    out.source = is_marked(view) ? MaskSource::kReference : MaskSource::kSegmented;
    if (supervises(view)) lift_and_add(view, out.mask);
  }

  const Exec& exec_;
  Monitor& monitor_;
  const SpreadOptions& options_;
  const SpreadInput& in_;
  ObjectPlace place_;                        // at the start of the pass
  WeightSums<> all_;                         // sum over lifted_mask_
  std::vector<PixelMask> lifted_mask_;       // per view; empty: none was lifted
  std::map<std::size_t, SpreadView> first_;  // views on which the object is marked
  std::vector<std::size_t> starts_;          // the same views
};

}  // namespace

std::vector<std::size_t> view_order(const std::vector<Camera>& cameras, const std::vector<std::size_t>& first,
                                    Vec3<double> focus) {
  std::vector<std::size_t> order;
  std::vector<double> nearest(cameras.size(), std::numeric_limits<double>::infinity());
  std::vector<std::uint8_t> done(cameras.size());
  while (order.size() < cameras.size()) {
    std::size_t next = cameras.size();
    if (order.size() < first.size()) {
      next = first[order.size()];
    } else {
      for (std::size_t v = 0; v < cameras.size(); ++v)
        if (!done[v] && (next == cameras.size() || nearest[v] < nearest[next])) next = v;
    }
    order.push_back(next);
    done[next] = 1;
    const Vec3<double> direction = cameras[next].centre() - focus;
    for (std::size_t v = 0; v < cameras.size(); ++v)
      if (!done[v]) nearest[v] = std::min(nearest[v], angle_between(cameras[v].centre() - focus, direction));
  }
  return order;
}

void spread_masks(const Exec& exec, Monitor& monitor, const SpreadOptions& options, const SpreadInput& input) {
  NGS_CHECK(input.camera.size() == input.scene.views.size() && input.has_photo.size() == input.camera.size() &&
                !input.marked.empty() && input.marked.rbegin()->first < input.camera.size(),
            "one camera per view, and marks on one of them");
  Spreader(exec, monitor, options, input).run();
}

}  // namespace ngs
