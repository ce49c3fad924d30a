// The losses at the ends of their ranges.                                                     Eqs. (16)-(19)
#include <doctest/doctest.h>

#include "ngs/ops/losses/loss_align.h"
#include "ngs/ops/losses/loss_align_kernels.h"
#include "ngs/ops/losses/loss_cont.h"
#include "ngs/ops/losses/loss_mask.h"
#include "ngs/ops/losses/loss_mask_kernels.h"
#include "ngs/ops/losses/loss_smooth.h"
#include "ngs/ops/losses/photometric_kernels.h"
#include "ngs/ops/neighbours/knn.h"
#include "support/stability.h"

namespace ngs {
namespace {

using test::Random;
using test::Worst;
using Real = long double;

/// Reference cross-entropy in long double, inside [ε, 1 - ε].
Real book_bce(Real p, Real m) { return -m * std::log(p) - (1 - m) * std::log1p(-p); }

ViewMasks masks_of(Random& random, int width, int height) {
  ViewMasks masks{.width_px = width, .height_px = height, .target = {}, .known = {}, .available = true};
  masks.target.resize(1);
  for (int i = 0; i < width * height; ++i) masks.target[0].push_back(float(random.below(2)));
  return masks;
}

/// The image with random values instead of its own.
ImageF filled(ImageF image, Random& random, double lo, double hi) {
  image.data = random.uniform_vector<float>(image.data.size(), lo, hi);
  return image;
}

}  // namespace

HARD_CASE("mask loss: predictions of exactly 0 and 1 have a finite loss and slope", "distance to the end",
          {0.1, 1e-6, 1e-20, 0}, 0, {"-log(p)", test::kWrong}) {
  for (const float p : {float(h), 1 - float(h)})
    for (const float m : {0.f, 1.f, 0.5f}) {
      const LossSlope<float> loss = mask_bce(p, m);
      worst.ours_is(std::isfinite(loss.value) && std::isfinite(loss.slope));
      worst.naive_is(std::isfinite(-m * std::log(p) - (1 - m) * std::log(1 - p)) &&
                     std::isfinite((1 - m) / (1 - p) - m / p));
    }
}

HARD_CASE("mask loss: a wrong saturated pixel still has the largest gradient", "distance to the end",
          {1e-2, 1e-5, 1e-7, 0}, 0.86, {"clamp(p, ε, 1 - ε) before the logarithm", 4e6}) {
  const float p = float(h * random.uniform(0.5, 1)), low = float(kMaskEps), at = std::max(p, low);
  worst.ours(mask_bce(p, 1.f).slope, -1 / Real(at));
  worst.naive(p < low ? 0.f : -1 / p, -1 / Real(at));
  worst.ours_is(mask_bce(1 - p, 0.f).slope >= 1 / (float(h) + low) * 0.4f);
}

HARD_CASE("mask loss: the cross-entropy of an almost right pixel keeps its relative accuracy", "p",
          {0.4, 1e-2, 1e-4, 2e-6}, 1.1, {"-log(1 - p)", 1e5}) {
  const float p = float(h * random.uniform(0.6, 1));
  worst.ours(mask_bce(p, 0.f).value, book_bce(p, 0));
  worst.naive(-std::log(1 - p), book_bce(p, 0));
  worst.ours(mask_bce(1 - p, 1.f).value, book_bce(1 - p, 1));
}

HARD_CASE("mask loss: beyond the clamped ends of the probability the loss continues along its tangent", "p",
          {1e-5, 1e-6, 1e-7, 1e-30, 0, -0.1}, 1.9, {"-log(p)", test::kWrong}) {
  const float p = float(h * random.uniform(0.5, 0.99)), low = float(kMaskEps);
  const Real want = p > low ? -std::log(Real(p)) : -std::log(Real(low)) + (low - Real(p)) / low;
  worst.ours(mask_bce(p, 1.f).value, want);
  worst.naive(-std::log(p), want);
}

HARD_CASE("mask loss: label logits of any size have a finite loss and gradient", "|logit|", {1, 20, 100, 1e4}, 0,
          {"-log(1 / (1 + e^x))", test::kWrong}) {
  const float x = float(h * random.uniform(0.9, 1));
  for (const float logit : {x, -x})
    for (const float m : {0.f, 1.f}) {
      const LossSlope<float> loss = mask_bce(sigmoid(logit), m);
      worst.ours_is(std::isfinite(loss.value) && std::isfinite(loss.slope * sigmoid_slope(logit)));
    }
  worst.naive_is(std::isfinite(-std::log(1 / (1 + std::exp(x)))));
}

HARD_CASE("mask loss: unknown pixels add nothing, whatever is rendered there", "rendered", {0.5, 1e30, INFINITY, NAN},
          0, {"known · loss", test::kWrong}) {
  ImageF rendered = filled({8, 6, 1}, random, 0.1, 0.9), clean = rendered;
  ViewMasks masks = masks_of(random, 8, 6);
  masks.known.assign(48, 1);
  const auto p = std::size_t(random.below(48));
  masks.known[p] = 0;
  rendered.data[p] = float(h);
  ImageF grad;
  const MaskLoss a = loss_mask({}, {}, {&rendered, &masks, nullptr, 1}, 1, &grad),
                 b = loss_mask({}, {}, {&clean, &masks, nullptr, 1}, 1, nullptr);
  worst.ours_is(a.total == b.total && a.known == 47 && grad.data[p] == 0);
  worst.naive_is(std::isfinite(0 * mask_bce(float(h), 1.f).value));
}

HARD_CASE("mask loss: the mean over many pixels is summed in double", "pixels", {100, 1e4, 1e6}, 0.63,
          {"a sum in float", 100}, 100) {
  const int side = int(std::sqrt(h));
  const ImageF rendered = filled({side, side, 1}, random, 0.3, 0.7);
  const ViewMasks masks = masks_of(random, side, side);
  Real want = 0;
  float naive = 0;
  for (std::size_t i = 0; i < rendered.data.size(); ++i) {
    want += book_bce(rendered.data[i], masks.target[0][i]);
    naive += mask_bce(rendered.data[i], masks.target[0][i]).value;
  }
  const Real n = Real(side) * side;
  worst.ours(float(loss_mask({}, {}, {&rendered, &masks, nullptr, 1}, 1, nullptr).total), want / n);
  worst.naive(naive / float(n), want / n);
}

HARD_CASE("mask loss: a view without known pixels has loss 0", "known pixels", {48, 1, 0}, 0,
          {"the sum over known pixels divided by their number", test::kWrong}) {
  const ImageF rendered = filled({8, 6, 1}, random, 0.1, 0.9);
  ViewMasks masks = masks_of(random, 8, 6);
  masks.known.assign(48, 0);
  std::fill_n(masks.known.begin(), int(h), std::uint8_t(1));
  ImageF grad;
  const MaskLoss loss = loss_mask({}, {}, {&rendered, &masks, nullptr, 1}, 1, &grad);
  Real want = 0;
  float sum = 0, known = 0;
  for (std::size_t p = 0; p < std::size_t(h); ++p) {
    want += book_bce(rendered.data[p], masks.target[0][p]) / Real(h);
    sum += mask_bce(rendered.data[p], masks.target[0][p]).value;
    known += 1;
  }
  const auto as_wanted = [&](double total) { return std::abs(total - double(want)) <= 1e-5 * double(want); };
  worst.ours_is(as_wanted(loss.total) && (h > 0 || grad.data == std::vector<float>(48, 0.f)));
  worst.naive_is(as_wanted(double(sum / known)));
}

HARD_CASE("align: the variance of a nearly constant patch survives a large offset", "mean / deviation",
          {1, 1e2, 1e4, 1e6}, 0.63, {"E[x²] - E[x]²", 6e4}) {
  const double deviation = 1e4 / h;
  const ImageF image = filled({7, 7, 3}, random, 1e4 - deviation, 1e4 + deviation);
  Real mean[3] = {}, want = 0;
  for (std::size_t i = 0; i < 147; ++i) mean[i % 3] += image.data[i] / 49.0L;
  for (std::size_t i = 0; i < 147; ++i) want += (image.data[i] - mean[i % 3]) * (image.data[i] - mean[i % 3]) / 49;
  Vec3<float> centre;
  const float got = patch_variance<float>({image.data.data(), 7, 7}, {0, 6, 0, 6}, centre);
  const Real kappa = 1e4L / std::sqrt(want), condition = 10 + 49 * 49 * 0x1p-23L * kappa * kappa;
  worst.ours(got, want, condition);
  float sum[3] = {}, squares = 0;
  for (std::size_t i = 0; i < 147; ++i) {
    sum[i % 3] += image.data[i];
    squares += image.data[i] * image.data[i];
  }
  worst.naive(squares / 49 - (sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]) / (49 * 49), want, condition);
}

HARD_CASE("align: the variance of a constant patch is not negative and zero up to rounding", "value", {0, 1, 1e4, 1e15},
          0.12, {"E[x²] - E[x]²", 1e5}) {
  const float value = float(h * random.uniform(0.5, 1));
  const ImageF image(7, 7, 3, value);
  Vec3<float> mean;
  const float got = patch_variance<float>({image.data.data(), 7, 7}, {0, 6, 0, 6}, mean);
  const double allowed = double(value) * 49 * 0x1p-24;  // of the mean
  worst.ours_ratio(got < 0 ? test::kWrong : h == 0 ? double(got) : double(got) / (3 * allowed * allowed));
  float sum = 0, squares = 0;
  for (int i = 0; i < 49; ++i) {
    sum += value;
    squares += value * value;
  }
  worst.naive_ratio(h == 0 ? 0 : std::abs(3 * double(squares / 49 - sum / 49 * (sum / 49))) / (3 * allowed * allowed));
}

namespace {

/// A random image and a grid of 4 x 3 active nodes on it, with a grey field.
struct AlignCase {
  ImageF colour, alpha;
  PixelGrid grid;
  std::vector<float> field_colour = std::vector<float>(36, 0.5f), field_alpha = std::vector<float>(12, 0.5f);
  std::vector<std::uint8_t> active = std::vector<std::uint8_t>(12, 1);

  explicit AlignCase(Random& random)
      : colour(filled({12, 10, 3}, random, 0, 1)), alpha(filled({12, 10, 1}, random, 0, 1)) {
    grid.first_x = 2;
    grid.first_y = 2;
    grid.cols = 4;
    grid.rows = 3;
    grid.step_x = grid.step_y = 2;
  }
  AlignInputs inputs() const {
    return {.grid = grid,
            .colour = &colour,
            .alpha = &alpha,
            .field_colour = &field_colour,
            .field_alpha = &field_alpha,
            .active = &active};
  }
};

}  // namespace

HARD_CASE("align: without active nodes the loss and its gradients are zero", "active nodes", {12, 0}, 0,
          {"the sum of the squares divided by the number of nodes", test::kWrong}) {
  AlignCase c(random);
  c.active.assign(12, h > 0);
  const AlignInputs in = c.inputs();
  AlignContext context;
  const AlignLoss loss = loss_align({}, {.weight_alpha = 0, .weight_variance = 0}, in, context);
  AlignFieldGradients field;
  ImageF grad_colour(12, 10, 3), grad_alpha(12, 10, 1);
  loss_align_backward({}, {}, in, context, {1, field, grad_colour, grad_alpha});
  bool zero = loss.total == 0;
  for (const auto* values : {&field.colour, &field.alpha, &grad_colour.data, &grad_alpha.data})
    for (const float x : *values) zero &= x == 0;
  worst.ours_is(zero == (h == 0));
  float squares = 0, nodes = 0;
  for (std::size_t r = 0; r < 12; ++r) nodes += float(c.active[r]);
  for (std::size_t i = 0; i < 36; ++i) squares += context.colour_residual[i] * context.colour_residual[i];
  worst.naive_is(std::abs(squares / nodes - float(loss.total)) <= 1e-5f * float(loss.total));
}

HARD_CASE("align: an inactive node adds nothing, whatever the field's value there", "field colour",
          {0.5, 1e30, INFINITY, NAN}, 0, {"active · residual", test::kWrong}) {
  AlignCase c(random);
  c.field_colour = random.uniform_vector<float>(36, 0, 1);
  const auto off = std::size_t(random.below(12));
  c.active[off] = 0;
  AlignLoss loss[2];
  ImageF to_colour[2];
  for (int k = 0; k < 2; ++k) {
    const AlignInputs in = c.inputs();
    AlignContext context;
    AlignFieldGradients field;
    ImageF to_alpha(12, 10, 1);
    to_colour[k] = ImageF(12, 10, 3);
    loss[k] = loss_align({}, {}, in, context);
    loss_align_backward({}, {}, in, context, {1, field, to_colour[k], to_alpha});
    worst.ours_is(field.colour[off * 3] == 0 && field.alpha[off] == 0);
    c.field_colour[off * 3] = float(h);
  }
  worst.ours_is(loss[0].total == loss[1].total && loss[0].nodes == 11 && to_colour[0].data == to_colour[1].data);
  const float residual = c.colour.at(2, 2, 0) - float(h);
  worst.naive_is(float(c.active[off]) * residual * residual == 0);
}

HARD_CASE("continuity: colours that nearly agree keep their squared difference", "difference", {1, 1e-2, 1e-4, 1e-6},
          2.5, {"|a|² - 2 a·b + |b|²", 8e11}) {
  std::vector<float> position = random.uniform_vector<float>(6, -1, 1),
                     colour = random.uniform_vector<float>(6, 0.4, 0.6);
  for (std::size_t c = 0; c < 3; ++c) colour[3 + c] = colour[c] + float(h * random.uniform(0.5, 1));
  const KnnGraph graph = nearest_others({}, {position.data(), 2}, 1);
  Real want = 0;
  float aa = 0, ab = 0, bb = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    want += (Real(colour[c]) - colour[3 + c]) * (Real(colour[c]) - colour[3 + c]);
    aa += colour[c] * colour[c];
    ab = std::fma(colour[c], colour[3 + c], ab);
    bb += colour[3 + c] * colour[3 + c];
  }
  if (want == 0) return;
  worst.ours(float(loss_cont({}, {graph, {colour.data(), 2}}, 1, nullptr)), want);
  worst.naive(aa - 2 * ab + bb, want);
}

HARD_CASE("continuity: one boundary Gaussian and none have loss 0", "|B|", {20, 2, 1, 0}, 0,
          {"the sum over all pairs divided by their number", test::kWrong}) {
  const auto count = std::size_t(h);
  const std::vector<float> position = random.uniform_vector<float>(count * 3, -1, 1);
  const Rows<const float, 3> colour{position.data(), std::int64_t(count)};
  const KnnGraph graph = nearest_others({}, colour, kMaxNeighbours);
  std::vector<float> grad;
  const double loss = loss_cont({}, {graph, colour}, 1, &grad);
  Real want = 0;
  float sum = 0, pairs = 0;
  for (std::size_t e = 0; e < graph.index.size(); ++e)
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t i = e / std::size_t(graph.neighbours);
      const float d = position[i * 3 + c] - position[graph.index[e] * 3 + c];
      want += Real(d) * d / Real(graph.index.size());
      sum += d * d;
      pairs += 1.f / 3;
    }
  const auto as_wanted = [&](double value) { return std::abs(value - double(want)) <= 1e-5 * double(want); };
  worst.ours_is(as_wanted(loss) && (count > 1 || grad == std::vector<float>(count * 3, 0.f)));
  worst.naive_is(as_wanted(double(sum / pairs)));
}

HARD_CASE("smoothness: a short step keeps the accuracy of the colours' difference", "difference",
          {1e-1, 1e-3, 1e-5, 1e-6}, 2.4, {"|a|² - 2 a·b + |b|²", 8e11}) {
  const auto a = random.uniform_vector<float>(3, 0.4, 0.6);
  std::vector<float> b = a;
  for (float& x : b) x += float(h * random.uniform(0.5, 1));
  SmoothnessGradients grad;
  const Real factor = 3 / (1e-4L * 1e-4L);
  const double loss = loss_smooth_backward({}, {1e-4, 1}, {a, b}, 1, grad);
  Real want = 0;
  float aa = 0, ab = 0, bb = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    want += (Real(a[c]) - b[c]) * (Real(a[c]) - b[c]);
    aa += a[c] * a[c];
    ab = std::fma(a[c], b[c], ab);
    bb += b[c] * b[c];
    if (a[c] != b[c]) worst.ours(grad.moved_colour[c], 2 * factor * (Real(b[c]) - a[c]));
  }
  if (want == 0) return;
  worst.ours(float(loss), factor * want);
  worst.naive(aa - 2 * ab + bb, want);
}

HARD_CASE("photometric: SSIM of an image with itself is 1, also where the image is constant", "contrast",
          {0.5, 1e-3, 0}, 2.6, {"without C1 and C2", test::kWrong}) {
  const float mean = h == 0 && random.below(2) ? 0.f : float(random.uniform(0, 1)),
              variance = float(h * h * random.uniform(0, 1));
  const float square = mean * mean + variance, moment[ssim::kMoments] = {mean, mean, 2 * square, square};
  float partial[ssim::kPartials];
  worst.ours(ssim::similarity(moment, partial), 1);
  for (const float g : partial) worst.ours_is(std::isfinite(g));
  const float s = square - mean * mean;
  worst.naive_is(std::isfinite(2 * mean * mean * 2 * s / ((mean * mean + mean * mean) * (s + s))));
}

}  // namespace ngs
