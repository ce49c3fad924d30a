#include "ngs/cut/evidence/variance_stage.h"

#include <algorithm>
#include <sstream>

#include "ngs/backend/for_each.h"
#include "ngs/math/mask_variance.h"
#include "ngs/problem/view_list.h"

namespace ngs {
namespace {

/// Normalised mask variance in [0, 1] of a Gaussian. `of`: the object's weight in it, the fraction `prob` of all.
double normalised_variance(Criterion criterion, const Evidence& e, std::size_t gaussian, const ObjectSums& of,
                           double prob) {
  switch (criterion) {
    case Criterion::kPooled: return mask_variance(prob);  // law of total variance over views and pixels
    case Criterion::kBetweenViews: return between_views_variance(of, e.views[gaussian]);
    case Criterion::kRelativeDiff: {  // 1 - r²: for binary evidence equal to 4 p (1 - p)
      const double r = double(e.contrast_sum(gaussian, of)) * 0x1p-32 / e.views[gaussian];
      return 1.0 - r * r;
    }
  }
  return 0.0;
}

/// Number of views whose masks are decoded in parallel: one image per thread, bounded for memory.
std::size_t views_ahead(const Exec& exec, std::size_t objects) {
  constexpr std::size_t kMaxPlanes = 36;
  return std::clamp<std::size_t>(kMaxPlanes / std::max<std::size_t>(objects, 1), 1,
                                 std::size_t(std::clamp(exec.threads, 1, 8)));
}

}  // namespace

Evidence accumulate_evidence(const Exec& exec, Monitor& monitor, const EvidenceInputs& in) {
  EvidenceSum evidence(exec, in.cloud, int(in.scene.objects.size()), prepared_for(exec, in.splat, in.cloud));
  const std::size_t ahead = views_ahead(exec, in.scene.objects.size());
  std::vector<ViewMasks> loaded;
  for_each_view(&monitor, in.views, [&](std::size_t n, std::size_t view) {
    if (n % ahead == 0) {
      const auto timed = monitor.scope("load masks");
      loaded.assign(std::min(ahead, in.views.size() - n), {});
      for_each_task(exec, std::int64_t(loaded.size()),
                    [&](std::int64_t i) { loaded[std::size_t(i)] = in.load_masks(in.views[n + std::size_t(i)]); });
    }
    const ViewMasks masks = std::move(loaded[n % ahead]);
    const auto timed = monitor.scope("evidence");
    evidence.add({in.scene.views[view].camera, masks});
  });
  return evidence.result();
}

void check_tau(const BoundaryRule& rule) {
  if (rule.tau >= 0 && rule.tau < 1) return;
  std::ostringstream found;
  found << "tau = " << rule.tau << ", expected a value in [0, 1): the normalised variance 4 Var never exceeds 1";
  throw Error(ErrorCode::kUsage, found.str(),
              "a raw variance threshold v (at most 0.25) is --tau 4v; the default is 0.6");
}

std::vector<LabelColumns> label_gaussians(const BoundaryRule& rule, const Evidence& e) {
  check_tau(rule);
  const auto n = std::size_t(e.gaussians);
  std::vector<LabelColumns> columns(std::size_t(e.objects));
  for (LabelColumns& c : columns)
    for (const auto column : kLabelColumns) (c.*column).assign(n, 0.f);
  LabelColumn views(n, 0.f);  // the same for all objects
  for (std::size_t i = 0; i < n; ++i) {
    if (e.views[i] == 0) continue;
    const bool one_of_several = rule.exclusive && e.objects > 1;
    const int owner = one_of_several ? e.heaviest_object(i) : -1;
    views[i] = float(e.views[i]);
    e.object_weights.for_each_in(i, [&](std::size_t k, const ObjectSums& of) {  // objects without weight keep zeros
      LabelColumns& c = columns[k];
      const double prob = e.prob(i, of);
      const double variance = normalised_variance(rule.criterion, e, i, of, prob);
      c.prob[i] = float(prob);
      c.variance[i] = float(variance);
      c.label[i] = one_of_several ? float(owner == int(k)) : float(is_object(rule, prob));
      c.boundary[i] = float(is_boundary(rule, variance));
    });
  }
  for (LabelColumns& c : columns) c.views = views;
  return columns;
}

}  // namespace ngs
