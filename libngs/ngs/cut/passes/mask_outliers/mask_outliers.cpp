#include "ngs/cut/passes/mask_outliers/mask_outliers.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "ngs/backend/for_each.h"
#include "ngs/cut/evidence/leave_one_out.h"
#include "ngs/math/median.h"
#include "ngs/ops/image/mask_pair.h"
#include "ngs/ops/optim/resident.h"
#include "ngs/ops/splat/evidence.h"
#include "ngs/problem/cloud_rows.h"
#include "ngs/problem/view_list.h"
#include "ngs/scene/mask_threshold.h"

namespace ngs {
namespace {

/// Binary masks of all objects, and the pixels at which they are known.
struct Planes {
  std::vector<std::vector<std::uint8_t>> object;  // [K][H·W]
  std::vector<std::uint8_t> compared;             // [H·W]
};

Planes planes_of(const Exec& exec, const ViewMasks& masks) {
  Planes p;
  p.object.resize(masks.target.size());
  for_each_task(exec, std::ssize(masks.target),
                [&](std::int64_t k) { p.object[std::size_t(k)] = object_pixels(masks.target[std::size_t(k)]); });
  p.compared.assign(p.object.front().size(), 1);
  if (!masks.known.empty()) p.compared = masks.known;
  return p;
}

constexpr double kNothingThere = -1, kNoMask = -2;
constexpr int kMinViews = 4;              // number of masks, and of masks that show an object, for a consensus
constexpr double kFactor = 3;             // an outlier has 1 - IoU above this many medians,
constexpr double kSpreads = 6;            // above the median plus this many standard deviations (1.4826 MAD),
constexpr double kMinDisagreement = 0.2;  // and above this value;
constexpr double kMaxDisagreement = 0.9;  // or above this value, if the median is below a half
constexpr int kMaxRounds = 3;             // each uses a consensus without the outliers so far
constexpr double kRetestShare = 0.5;      // share of the threshold; views below it are not tested again

/// 1 - IoU over all objects, at the pixels known in both; kNothingThere if neither shows any object.
double disagreement(const Exec& exec, const Planes& mask, const Planes& consensus) {
  std::vector<std::int64_t> both(mask.object.size(), 0), either = both;
  for_each_task(exec, std::ssize(mask.object), [&](std::int64_t task) {
    const auto k = std::size_t(task);
    const std::uint8_t *own = mask.object[k].data(), *its = consensus.object[k].data();
    const std::uint8_t *own_known = mask.compared.data(), *its_known = consensus.compared.data();
    std::int64_t and_px = 0, or_px = 0;
    for (std::size_t i = 0; i < mask.compared.size(); ++i) {
      const bool known = (own_known[i] != 0) & (its_known[i] != 0), m = own[i] != 0, c = its[i] != 0;
      and_px += known & m & c;
      or_px += known & (m | c);
    }
    both[k] = and_px;
    either[k] = or_px;
  });
  const auto all = std::accumulate(either.begin(), either.end(), std::int64_t(0));
  if (all == 0) return kNothingThere;
  return 1 - double(std::accumulate(both.begin(), both.end(), std::int64_t(0))) / double(all);
}

/// Majority labels of the views as label channels. An optional last channel is 1 for Gaussians that these views see.
struct Consensus {
  std::size_t objects, channels;
  std::vector<float> label;          // [N, channels]
  std::vector<std::uint8_t> object;  // [N] 1: one of the labels is 1

  Consensus(std::size_t gaussians, std::size_t k, bool seen)
      : objects(k), channels(k + std::size_t(seen)), label(gaussians * channels, 0.f), object(gaussians, 0) {}
  /// `share`: [K].
  void set(std::size_t gaussian, const auto& share, bool seen) {
    float* to = &label[gaussian * channels];
    object[gaussian] = 0;
    for (std::size_t k = 0; k < objects; ++k) {
      to[k] = label_is_foreground(share[k]) ? 1.f : 0.f;
      object[gaussian] |= to[k] > 0;
    }
    if (channels > objects) to[objects] = float(seen);
  }
  void set(std::size_t gaussian, const LeaveOneOut::Shares& shares) { set(gaussian, shares.share, shares.seen); }
};

/// Renders a consensus into the views of a problem and compares it with their masks.
class ConsensusViews {
 public:
  ConsensusViews(const Exec& exec, const Problem& input, const Consensus& consensus)
      : exec_(exec), input_(input), consensus_(consensus) {
    request_.colour = false;
    request_.label = {consensus.label.data(), input.cloud.size(), int(consensus.channels)};
  }

  /// Call after the consensus has changed. With a device: copies it to its memory.
  void update() {
    resident_.emplace(exec_);
    resident_->add_input(consensus_.label);
    resident_->add_input(consensus_.object);
  }

  /// The smaller disagreement of a mask with the two renderings of the consensus. The whole model is not rendered if
  /// neither the mask nor the object alone shows anything, or if these disagree by at most `enough`.
  /// `shown` [N]: 1 for the Gaussians visible in the view; null: all.
  double disagreement_of(const Camera& camera, const Planes& mask, const std::uint8_t* shown, double enough) {
    request_.include = consensus_.object.data();
    request_.tiles_touching = request_.stop_after = nullptr;
    const double alone = disagreement(exec_, mask, drawn(camera, false));
    if (alone == kNothingThere || alone <= enough) return alone;
    request_.include = shown;
    // Tiles without an object show no consensus and can be skipped. The "seen" channel is needed at every pixel.
    request_.tiles_touching = request_.stop_after = has_seen_channel() ? nullptr : consensus_.object.data();
    return std::min(alone, disagreement(exec_, mask, drawn(camera, has_seen_channel())));
  }

 private:
  bool has_seen_channel() const { return consensus_.channels > consensus_.objects; }
  /// `seen_only`: pixels are known only if the other views see most of their weight.
  Planes drawn(const Camera& camera, bool seen_only) const {
    const RenderedView view = render(exec_, input_.cloud, camera, input_.splat, request_);
    const std::size_t pixels = std::size_t(view.label.pixels());
    Planes p{{}, std::vector<std::uint8_t>(pixels, 1)};
    p.object.assign(consensus_.objects, std::vector<std::uint8_t>(pixels));
    for_each_index(exec_, view.label.pixels(), [&](std::int64_t pixel) {
      const auto i = std::size_t(pixel);
      const float* at = &view.label.data[i * consensus_.channels];
      for (std::size_t k = 0; k < consensus_.objects; ++k) p.object[k][i] = label_is_foreground(at[k]);
      if (seen_only) p.compared[i] = at[consensus_.objects] > 0.5f;
    });
    return p;
  }

  const Exec& exec_;
  const Problem& input_;
  const Consensus& consensus_;
  RenderRequest request_;
  std::optional<Resident> resident_;  // consensus_
};

class OutlierSearch {
 public:
  OutlierSearch(const Exec& exec, const Problem& input, const std::vector<double>& pretest)
      : exec_(exec),
        input_(input),
        uncropped_(input.whole()),
        inlier_(input.views.size(), 1),
        gathered_(input.views.size(), 0),
        found_(pretest.empty() ? std::vector<double>(input.views.size(), INFINITY) : pretest) {}

  MaskOutliers run(Monitor& monitor) {
    const auto timed = monitor.scope("mask outliers");
    MaskOutliers result;
    int rounds = 0;
    if (std::ranges::none_of(found_, [](double d) { return d == INFINITY; })) set_threshold(result);
    result.figures["rounds"] = 0;
    if (!has_unclear_views()) return result;
    seen_ = RowNumbers(seen_rows());
    Resident flags(exec_);
    flags.add_input(seen_.chosen);
    LeaveOneOut others(exec_, seen_.size(), int(input_.scene.objects.size()), [this](std::size_t n) {
      const std::size_t view = input_.views[n];
      return packed_sums(exec_, uncropped_.cloud, {uncropped_.scene.views[view].camera, uncropped_.load_masks(view)},
                         uncropped_.splat, &seen_);
    });
    if (known_weight()) {
      std::vector<std::size_t> all(input_.views.size());
      std::iota(all.begin(), all.end(), std::size_t(0));
      others.start(gather_labels(exec_, input_.labels, seen_.row), gather_column(exec_, *known_weight(), 1, seen_.row),
                   all);
      gathered_.assign(all.size(), 1);
    }
    while (rounds < kMaxRounds && !monitor.stop_requested()) {
      {
        const auto gathering = monitor.scope("evidence");
        if (!gather(others)) break;
      }
      ++rounds;
      const auto testing = monitor.scope("consensus");
      if (!test_views(others, result)) break;
    }
    for (std::size_t n = 0; n < inlier_.size(); ++n)
      if (!inlier_[n]) result.ignored.push_back(input_.views[n]);
    result.figures["rounds"] = rounds;
    return result;
  }

 private:
  const Camera& camera(std::size_t n) const { return input_.scene.views[input_.views[n]].camera; }

  /// [N] Total weight W over all views; null: unknown.
  const std::vector<float>* known_weight() const {
    return input_.uncropped && uncropped_.weight ? &*uncropped_.weight : nullptr;
  }
  /// [N] 1: some view may show the Gaussian.
  std::vector<std::uint8_t> seen_rows() const {
    std::vector<std::uint8_t> seen(std::size_t(input_.cloud.size()), 1);
    if (const std::vector<float>* const weight = known_weight())
      for (std::size_t i = 0; i < seen.size(); ++i) seen[i] = (*weight)[i] > 0;
    return seen;
  }

  /// Updates the evidence to the current inlier views. False: too few of them have masks, or a stop was requested.
  bool gather(LeaveOneOut& others) {
    int with_masks = 0;
    const bool all = for_each_view(input_.monitor, input_.views, [&](std::size_t n, std::size_t view) {
      if (gathered_[n] && !inlier_[n]) others.remove(n);
      if (!gathered_[n] && inlier_[n]) others.add(n);
      gathered_[n] = inlier_[n];
      if (inlier_[n]) with_masks += input_.load_masks(view).available;
    });
    return all && with_masks >= kMinViews;
  }

  /// Tests the views. True: the set of outliers changed. Views in which mask and consensus show no object are inliers,
  /// and do not enter the median: if most views do not see the object, the median would be 0.
  bool test_views(LeaveOneOut& others, MaskOutliers& result) {
    const auto gaussians = std::size_t(input_.cloud.size());
    Consensus consensus(gaussians, input_.scene.objects.size(), true);
    ConsensusViews views(exec_, input_, consensus);
    std::vector<std::uint8_t> shown(gaussians, 0);
    others.for_all([&](std::size_t i, const LeaveOneOut::Shares& all) { consensus.set(row(i), all); });
    const bool every = for_each_view(input_.monitor, input_.views, [&](std::size_t n, std::size_t view) {
      if (is_clear_inlier(n)) return;
      const ViewMasks masks = input_.load_masks(view);
      if (!masks.available) {
        found_[n] = kNoMask;
        return;
      }
      const std::shared_ptr<const PackedSums> own = others.weights_of(n);
      const bool has_weights = own && !own->empty();  // visible Gaussians are known; otherwise all are rendered
      if (has_weights)
        others.for_others_in(*own, [&](std::size_t i, const LeaveOneOut::Shares& shares, double) {
          consensus.set(row(i), shares);
          shown[row(i)] = 1;
        });
      views.update();
      found_[n] = views.disagreement_of(camera(n), planes_of(exec_, masks), has_weights ? shown.data() : nullptr,
                                        kNothingThere);
      if (has_weights)
        others.for_all_in(*own, [&](std::size_t i, const LeaveOneOut::Shares& all) {
          consensus.set(row(i), all);
          shown[row(i)] = 0;
        });
    });
    if (!set_threshold(result) || !every) return false;
    bool changed = false;
    for (std::size_t n = 0; n < inlier_.size(); ++n) {
      const std::uint8_t now = result.disagreement[n] <= threshold_;
      changed |= now != inlier_[n];
      inlier_[n] = now;
    }
    return changed;
  }

  std::size_t row(std::size_t number) const { return std::size_t(seen_.row[number]); }
  bool is_clear_inlier(std::size_t n) const { return found_[n] < kRetestShare * threshold_; }
  /// True: some view must be tested against the consensus of the others.
  bool has_unclear_views() const {
    bool any = false;
    for (std::size_t n = 0; n < found_.size(); ++n) any |= !is_clear_inlier(n);
    return any;
  }

  /// Copies the disagreements to the result and sets the threshold. False: too few views show an object.
  bool set_threshold(MaskOutliers& result) {
    std::vector<double> all;
    result.disagreement.assign(found_.size(), -1.0);
    for (std::size_t n = 0; n < found_.size(); ++n) {
      result.disagreement[n] = found_[n] == kNoMask ? -1.0 : std::max(found_[n], 0.0);
      if (found_[n] >= 0) all.push_back(found_[n]);
    }
    if (std::ssize(all) < kMinViews) return false;
    threshold_ = ignore_threshold(all, result.figures["median_disagreement"]);
    result.figures["threshold"] = threshold_;
    return true;
  }

  const Exec& exec_;
  const Problem& input_;
  const Problem& uncropped_;                     // the uncropped problem, from which evidence is gathered
  RowNumbers seen_;                              // Gaussians with evidence
  std::vector<std::uint8_t> inlier_, gathered_;  // per entry of input.views
  std::vector<double> found_;                    // per entry of input.views: disagreement, kNothingThere or kNoMask
  double threshold_ = 0;                         // of the previous round
};

}  // namespace

double ignore_threshold(const std::vector<double>& disagreement, double& median) {
  constexpr double kMadToSigma = 1.4826;  // of a normal distribution
  median = upper_median(disagreement);
  std::vector<double> deviations;
  for (const double d : disagreement) deviations.push_back(std::abs(d - median));
  const double sigma = kMadToSigma * upper_median(std::move(deviations));
  const double threshold = std::max({kFactor * median, median + kSpreads * sigma, kMinDisagreement});
  // With three empty masks of nine, the deviation is so large that no 1 - IoU could exceed the threshold.
  const bool has_extreme = *std::max_element(disagreement.begin(), disagreement.end()) > kMaxDisagreement;
  return has_extreme && median < 0.5 ? std::min(threshold, kMaxDisagreement) : threshold;
}

std::vector<double> pretest_masks(const Exec& exec, const Problem& input) {
  const std::size_t objects = input.labels.size();
  if (input.views.size() < kPretestViews || objects == 0) return {};
  Consensus consensus(std::size_t(input.cloud.size()), objects, false);
  for_each_index(exec, input.cloud.size(), [&](std::int64_t i) {
    float* to = &consensus.label[std::size_t(i) * objects];
    for (std::size_t k = 0; k < objects; ++k) {
      to[k] = label_is_foreground(input.labels[k].label[std::size_t(i)]) ? 1.f : 0.f;
      consensus.object[std::size_t(i)] |= to[k] > 0;
    }
  });
  ConsensusViews views(exec, input, consensus);
  views.update();
  std::vector<double> found(input.views.size(), kNoMask);
  const bool every = for_each_view(input.monitor, input.views, [&](std::size_t n, std::size_t view) {
    const ViewMasks masks = input.load_masks(view);
    if (masks.available)
      found[n] = views.disagreement_of(input.scene.views[view].camera, planes_of(exec, masks), nullptr,
                                       kRetestShare * kMinDisagreement);
  });
  return every ? found : std::vector<double>();
}

MaskOutliers find_mask_outliers(const Exec& exec, Monitor& monitor, const Problem& input,
                                const std::vector<double>& pretest) {
  return OutlierSearch(exec, input, pretest).run(monitor);
}

double outlier_score(const std::vector<double>& disagreement) {
  if (disagreement.size() < 2) return 0;
  double median = 0;
  return *std::max_element(disagreement.begin(), disagreement.end()) / (0.5 * ignore_threshold(disagreement, median));
}

ViewMasks consistent_masks(const MaskOutliers& outliers, std::size_t view, ViewMasks masks) {
  if (std::binary_search(outliers.ignored.begin(), outliers.ignored.end(), view)) masks.available = false;
  return masks;
}

}  // namespace ngs
