// Mask evidence: sums, merges, counts, variances and degenerate cases.                       paper.md §5.2
#include <doctest/doctest.h>

#include <algorithm>

#include "ngs/cut/evidence/variance_stage.h"
#include "ngs/ops/splat/evidence.h"
#include "support/cameras.h"
#include "support/same_evidence.h"
#include "support/stability.h"

namespace ngs {
namespace {

using test::Random;
using test::Worst;
using Real = long double;

constexpr int kSize = 32;

struct Capture {
  GaussianCloud cloud;
  Camera camera = test::camera_along_z(kSize, kSize, 60);
  ViewMasks masks{kSize, kSize, {std::vector<float>(kSize * kSize)}, {}, true};
  explicit Capture(Random& random, int gaussians = 6) {
    cloud.resize(gaussians, 0);
    for (std::size_t i = 0; i < std::size_t(gaussians); ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        cloud.position[i * 3 + k] = float(random.uniform(-0.3, 0.3)) + (k == 2 ? 2.f : 0.f);
        cloud.log_scale[i * 3 + k] = float(random.uniform(-4, -2));
      }
      for (std::size_t k = 0; k < 4; ++k) cloud.rotation[i * 4 + k] = float(random.uniform(-1, 1));
      cloud.logit_opacity[i] = float(random.uniform(-3, 3));
    }
  }
  Evidence evidence() const {
    Evidence e(cloud.size(), 1);
    add_view_evidence({}, cloud, {camera, masks}, {}, e);
    return e;
  }
};

LabelColumns labels(const Evidence& e, Criterion criterion = Criterion::kPooled) {
  VarianceOptions options;
  options.criterion = criterion;
  return label_gaussians(options, e)[0];
}

/// Evidence of one Gaussian with the given per-view signals.
Evidence of_signals(const std::vector<double>& signals) {
  Evidence e(1, 1);
  for (const double m : signals) {
    ObjectSums& of = e.object_weights.touch(0, 0);
    of.add_signal(m);
    of.weight.add(m);
    e.weight.add(0, 1);
    ++e.views[0];
  }
  return e;
}

}  // namespace

HARD_CASE("evidence: a mask that is empty everywhere gives probability exactly 0", "mask", {0}, 0,
          "not applicable: a sum of zeros is exact in any form") {
  const Capture c(random);
  const Evidence e = c.evidence();
  const LabelColumns l = labels(e);
  for (std::size_t i = 0; i < l.prob.size(); ++i)
    worst.ours_is(e.object_weight(i, 0) == 0 && l.prob[i] == 0 && l.variance[i] == 0 && l.label[i] == 0);
}

HARD_CASE("evidence: a mask that is full everywhere gives probability exactly 1, for any split into parts", "parts",
          {1, 4, kSize}, 0, {"W1 / W, each summed in float in its own order", 1}, 10) {
  Capture c(random);
  c.masks.target[0].assign(kSize * kSize, 1.f);
  const int parts = int(h), pixels = kSize * kSize / parts;
  Evidence sum(c.cloud.size(), 1);
  std::vector<Evidence> part;
  for (int k = 0; k < parts; ++k) {
    c.masks.known.assign(kSize * kSize, 0);
    std::fill_n(c.masks.known.begin() + k * pixels, pixels, std::uint8_t(1));
    part.push_back(c.evidence());
    sum.add(part.back());
  }
  const LabelColumns l = labels(sum);
  for (std::size_t i = 0; i < l.prob.size(); ++i) {
    if (sum.views[i] == 0) continue;
    worst.ours_is(l.prob[i] == 1 && l.variance[i] == 0 && l.label[i] == 1 &&
                  sum.pixels[i] == test::object_pixels(sum, i, 0));
    float weight = 0, object_weight = 0;
    for (std::size_t k = 0; k < part.size(); ++k) {
      weight += float(part[k].weight.value(i));
      object_weight += float(part[part.size() - 1 - k].object_weight(i, 0));
    }
    worst.naive(object_weight / weight, 1);
  }
}

HARD_CASE("evidence: a mask that is half everywhere gives probability one half and the largest variance", "mask", {0.5},
          0, "not applicable: halving is exact in any form") {
  Capture c(random);
  c.masks.target[0].assign(kSize * kSize, 0.5f);
  const Evidence e = c.evidence();
  const LabelColumns l = labels(e);
  for (std::size_t i = 0; i < l.prob.size(); ++i)
    worst.ours_is(e.views[i] == 0 || (l.prob[i] == 0.5f && l.variance[i] == 1 && l.label[i] == 0));
}

HARD_CASE("evidence: a Gaussian whose pixels agree has probability 0 or 1 and variance 0, also with one pixel",
          "known pixels", {kSize * kSize, 1}, 0, {"1 - r², r = |n+ - n-| / (n+ + n- + 1e-6)", test::kWrong}) {
  Capture c(random, 1);
  c.cloud.position = {0, 0, 2};
  c.cloud.logit_opacity[0] = 2;
  std::fill(c.cloud.log_scale.begin(), c.cloud.log_scale.end(), -2.f);
  const bool inside = random.uniform(0, 1) < 0.5;
  c.masks.target[0].assign(kSize * kSize, inside ? 1.f : 0.f);
  c.masks.known.assign(kSize * kSize, h > 1 ? 1 : 0);
  c.masks.known[std::size_t(kSize / 2 * kSize + kSize / 2)] = 1;
  const Evidence e = c.evidence();
  const LabelColumns l = labels(e), r = labels(e, Criterion::kRelativeDiff);
  worst.ours_is((e.pixels[0] == 1) == (h == 1) && e.views[0] == 1 && l.prob[0] == (inside ? 1.f : 0.f) &&
                r.variance[0] == 0);
  const float in = float(test::object_pixels(e, 0, 0)), out = float(e.pixels[0]) - in;
  const float contrast = std::abs(in - out) / (in + out + 1e-6f);
  worst.naive_is(1 - contrast * contrast == 0);
}

HARD_CASE("evidence: a Gaussian without known pixels is unseen, neither object nor background", "known pixels",
          {kSize * kSize, 0}, 0, {"W1 / W", test::kWrong}) {
  Capture c(random, 1);
  c.masks.known.assign(kSize * kSize, h > 0 ? 1 : 0);
  Evidence e = c.evidence();
  e.object_weights.touch(0, 0);  // an empty share, as a file may contain
  for (const Criterion criterion : {Criterion::kPooled, Criterion::kBetweenViews, Criterion::kRelativeDiff}) {
    const LabelColumns l = labels(e, criterion);
    worst.ours_is((l.views[0] == 0) == (h == 0) && l.prob[0] == 0 && l.label[0] == 0 && l.variance[0] == 0);
  }
  worst.naive_is(float(e.object_weight(0, 0)) / float(e.weight.value(0)) == 0);
}

HARD_CASE("evidence: merged parts equal one run, in any order and any sharding", "views", {2, 8, 40}, 0,
          {"weights summed in float", test::kWrong}) {
  Capture c(random);
  std::vector<Evidence> parts;
  for (int v = 0; v < int(h); ++v) {
    for (float& m : c.masks.target[0]) m = float(random.below(2));
    c.camera.cx = 16 + random.uniform(-3, 3);
    parts.push_back(c.evidence());
  }
  Evidence once(c.cloud.size(), 1), merged(c.cloud.size(), 1), shard[2] = {merged, merged};
  for (const Evidence& e : parts) once.add(e);
  for (std::size_t k = parts.size(); k-- > 0;) shard[random.below(2)].add(parts[k]);
  merged.add(shard[1]);
  merged.add(shard[0]);
  worst.ours_is(test::same_evidence(once, merged));
  float forwards = 0, backwards = 0;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    forwards += float(parts[k].weight.value(0));
    backwards += float(parts[parts.size() - 1 - k].weight.value(0));
  }
  worst.naive_is(forwards == backwards);
}

HARD_CASE("evidence: weights over thirty decades give one probability, in any order and exact to rounding", "decades",
          {0, 1, 10, 20, 30}, 0.87, {"W1 / W of sums in float", 1}) {
  struct Term {
    double weight;
    bool inside;
  };
  std::vector<Term> terms;
  Evidence e(1, 1), backwards(1, 1);
  Real object = 0, rest = 0;
  float naive = 0, naive_object = 0;
  for (int k = 0; k < 64; ++k) {
    const std::int64_t most = 1 << (h > 0 ? 20 : 16);  // 0 decades: sums that float holds
    const double w = std::ldexp(double(1 + random.below(most)), -64 + int(random.below(1 + int(3.3 * h))));
    terms.push_back({w, random.below(2) == 1});
    (terms.back().inside ? object : rest) += w;
    naive += float(w);
    naive_object += terms.back().inside ? float(w) : 0.f;
  }
  const auto add = [](Evidence& to, const Term& t) {
    to.weight.add(0, t.weight);
    to.object_weights.touch(0, 0).weight.add(t.inside ? t.weight : 0.0);
  };
  for (const Term& t : terms) add(e, t);
  std::reverse(terms.begin(), terms.end());
  for (const Term& t : terms) add(backwards, t);
  e.views[0] = backwards.views[0] = 1;
  const float prob = labels(e).prob[0];
  worst.ours(prob, object / (object + rest));
  worst.ours_is(test::same_evidence(e, backwards) && labels(backwards).prob[0] == prob);
  worst.naive(naive_object / naive, object / (object + rest));
}

HARD_CASE("evidence: a hundred thousand views add up without loss", "views", {1, 1e3, 1e5}, 0.75,
          {"weights summed in float", 3000}, 100) {
  const Evidence one = Capture(random, 2).evidence();
  Evidence sum(2, 1);
  float naive = 0;
  for (int v = 0; v < int(h); ++v) {
    sum.add(one);
    naive += float(one.weight.value(0));
  }
  worst.ours_is(sum.pixels[0] == one.pixels[0] * std::uint64_t(h) && sum.views[0] == one.views[0] * std::uint32_t(h));
  const Real want = Real(one.weight.value(0)) * Real(h);
  if (want > 0) {
    worst.ours(float(sum.weight.value(0)), want);
    worst.naive(naive, want);
  }
}

HARD_CASE("evidence: pixel counts pass 2^32", "pixels", {1e3, 4e9, 1e12, 9e15}, 0,
          {"counts in 32 bits", test::kWrong}) {
  Evidence part(1, 1), sum(1, 1);
  part.pixels[0] = std::uint64_t(h) + std::uint64_t(random.below(1000));
  part.object_weights.touch(0, 0).pixels = part.pixels[0] / 2;
  for (int k = 0; k < 7; ++k) sum.add(part);
  worst.ours_is(sum.pixels[0] == 7 * part.pixels[0] &&
                test::object_pixels(sum, 0, 0) == 7 * test::object_pixels(part, 0, 0));
  worst.naive_is(std::uint32_t(7 * part.pixels[0]) == 7 * part.pixels[0]);
}

HARD_CASE("evidence: equal signals have variance exactly 0", "views", {1, 2, 7, 1000}, 0,
          {"E[m²] - E[m]²", test::kWrong}) {
  const double m = random.uniform(0, 1);
  const Evidence e = of_signals(std::vector<double>(std::size_t(h), m));
  worst.ours_is(between_views_variance(*e.object_weights.find(0, 0), e.views[0]) == 0 &&
                labels(e, Criterion::kBetweenViews).variance[0] == 0);
  float sum = 0, squares = 0;
  for (int v = 0; v < int(h); ++v) {
    sum += float(m);
    squares += float(m) * float(m);
  }
  worst.naive_is(squares / float(h) - sum / float(h) * (sum / float(h)) == 0);
}

HARD_CASE("evidence: nearly equal signals keep their variance", "spread of m", {1e-1, 1e-3, 1e-5, 1e-7}, 0.86,
          {"E[m²] - E[m]²", 8e15}) {
  std::vector<double> signals;
  const double centre = random.uniform(0.3, 0.7);
  for (int v = 0; v < 100; ++v)
    signals.push_back(std::nearbyint((centre + h * random.uniform(-0.5, 0.5)) * 0x1p32) * 0x1p-32);
  const Evidence e = of_signals(signals);
  Real mean = 0, want = 0;
  for (const double m : signals) mean += m / 100.0L;
  for (const double m : signals) want += 4 * (m - mean) * (m - mean) / 100;
  worst.ours(float(between_views_variance(*e.object_weights.find(0, 0), 100)), want);
  float sum = 0, squares = 0;
  for (const double m : signals) {
    sum += float(m);
    squares += float(m) * float(m);
  }
  worst.naive(4 * (squares / 100 - sum / 100 * (sum / 100)), want);
}

HARD_CASE("evidence: the pooled variance of an almost certain Gaussian keeps its accuracy", "1 - p",
          {0.5, 1e-3, 1e-6, 1e-8}, 0.87, {"4 p (1 - p) in float", 8e7}) {
  Evidence e(1, 1);
  const double total = random.uniform(10, 1000), outside = total * h * random.uniform(0.5, 1);
  e.weight.add(0, total);
  e.object_weights.touch(0, 0).weight.add(total - outside);
  e.views[0] = 1;
  const Real p = Real(e.object_weight(0, 0)) / e.weight.value(0), want = 4 * p * (1 - p);
  worst.ours(float(labels(e).variance[0]), want);
  const float q = float(e.object_weight(0, 0)) / float(e.weight.value(0));
  worst.naive(4 * q * (1 - q), want);
}

}  // namespace ngs
