// Device against CPU: the losses with their gradients, and Adam.
#include "ngs/core/error.h"
#include "ngs/ops/losses/loss_align.h"
#include "ngs/ops/losses/loss_cont.h"
#include "ngs/ops/losses/loss_mask.h"
#include "ngs/ops/losses/loss_smooth.h"
#include "ngs/ops/losses/photometric.h"
#include "ngs/ops/neighbours/knn.h"
#include "ngs/ops/optim/adam.h"
#include "parity/backends.h"
#include "support/random.h"

namespace ngs::test {
namespace {

/// Values from -beyond to 1 + beyond.
ImageF random_image(Random& random, int width, int height, int channels, double beyond = 0) {
  ImageF image(width, height, channels);
  for (float& x : image.data) x = float(random.uniform(-beyond, 1 + beyond));
  return image;
}

double relative(double got, double want) {
  return std::abs(got - want) / (double(std::numeric_limits<float>::epsilon()) * std::max(std::abs(want), 1e-6));
}

}  // namespace

TEST_CASE("align: value and gradients of a device equal the CPU's within rounding") {
  for (const Backend& b : backends())
    for (const bool with_gate : {false, true}) {
      Random random(1);
      const PixelGrid grid{-1.5, 3.2, 2.5, 3.1, 16, 9};  // beyond the image to the left
      const auto nodes = std::size_t(grid.nodes());
      const ImageF colour = random_image(random, 37, 29, 3), alpha = random_image(random, 37, 29, 1);
      const auto field_colour = random.uniform_vector<float>(nodes * 3, 0, 1),
                 field_alpha = random.uniform_vector<float>(nodes, 0, 1);
      std::vector<std::uint8_t> active(nodes);
      for (auto& a : active) a = random.below(3) != 0;
      const AlignInputs in{grid, &colour, &alpha, &field_colour, &field_alpha, with_gate ? &active : nullptr};
      AlignContext want_context, got_context;
      const AlignLoss want = loss_align({}, {}, in, want_context), got = loss_align(b.exec, {}, in, got_context);
      CHECK(got.nodes == want.nodes);
      check_ratio(b, "align loss", relative(got.total, want.total), 1);
      AlignFieldGradients want_field, got_field;
      ImageF want_colour = random_image(random, 37, 29, 3), want_alpha = random_image(random, 37, 29, 1);
      ImageF got_colour = want_colour, got_alpha = want_alpha;  // gradients are added
      loss_align_backward({}, {}, in, want_context, {0.7, want_field, want_colour, want_alpha});
      loss_align_backward(b.exec, {}, in, got_context, {0.7, got_field, got_colour, got_alpha});
      CHECK(got_field.colour == want_field.colour);
      CHECK(got_field.alpha == want_field.alpha);
      CHECK(got_colour.data == want_colour.data);
      CHECK(got_alpha.data == want_alpha.data);
    }
}

TEST_CASE("mask loss and density weights of a device equal the CPU's within rounding") {
  for (const Backend& b : backends())
    for (const MaskLossForm form : {MaskLossForm::kBce, MaskLossForm::kLinear})
      for (const int objects : {1, 3, 17}) {
        Random random(2);
        const ImageF rendered = random_image(random, 37, 29, objects, 0.01);
        ViewMasks masks{.width_px = 37, .height_px = 29, .target = {}, .known = {}, .available = true};
        for (int k = 0; k < objects; ++k) masks.target.push_back(random.uniform_vector<float>(37 * 29, 0, 1));
        if (objects == 3)
          for (int i = 0; i < 37 * 29; ++i) masks.known.push_back(random.below(3) != 0);
        const PixelGrid grid{4.5, 3.2, 2.5, 3.1, 10, 6};
        const auto depth = random.uniform_vector<float>(60, 0, 5);
        ImageF want_weight(37, 29, 1), got_weight(37, 29, 1);
        density_weights({}, {grid, {3, 1, 31, 22}, depth}, want_weight);
        density_weights(b.exec, {grid, {3, 1, 31, 22}, depth}, got_weight);
        check_ratio(b, "density weight", worst_ratio(got_weight.data, want_weight.data, 1), 4);
        ImageF want_grad, got_grad;
        const MaskLossInputs in{&rendered, &masks, objects == 3 ? &want_weight : nullptr, 0.9};
        const MaskLoss want = loss_mask({}, {form, 0.3}, in, 1.3, &want_grad),
                       got = loss_mask(b.exec, {form, 0.3}, in, 1.3, &got_grad);
        CHECK(got.known == want.known);
        check_ratio(b, "mask loss", relative(got.total, want.total), 4);
        CHECK(got_grad.data == want_grad.data);  // quotients only
        CHECK(loss_mask(b.exec, {form, 0.3}, in, 1.3, nullptr).total == got.total);
      }
}

TEST_CASE("continuity and smoothness of a device equal the CPU's within rounding") {
  for (const Backend& b : backends())
    for (const std::int64_t n : {2, 300}) {
      Random random(3);
      const auto points = random.uniform_vector<float>(std::size_t(n) * 3, -1, 1),
                 colour = random.uniform_vector<float>(std::size_t(n) * 3, 0, 1),
                 moved = random.uniform_vector<float>(std::size_t(n) * 3, 0, 1);
      const KnnGraph graph = nearest_others({}, {points.data(), n}, 8);
      const auto weight = random.uniform_vector<float>(graph.index.size(), 0, 1);
      for (const bool weighted : {false, true}) {
        std::vector<float> want_grad, got_grad;
        const std::vector<float> weights = weighted ? weight : std::vector<float>{};
        const double want = loss_cont({}, {graph, {colour.data(), n}, weights}, 0.4, &want_grad),
                     got = loss_cont(b.exec, {graph, {colour.data(), n}, weights}, 0.4, &got_grad);
        check_ratio(b, "continuity loss", relative(got, want), 1e-3);  // the order of a sum in double
        CHECK(got_grad == want_grad);
        CHECK(loss_cont(b.exec, {graph, {colour.data(), n}, weights}, 0.4, nullptr) == got);
      }
      SmoothnessGradients want, got;
      CHECK(loss_smooth_backward(b.exec, {0.1, 0.3}, {colour, moved}, 0.2, got) ==
            loss_smooth_backward({}, {0.1, 0.3}, {colour, moved}, 0.2, want));
      CHECK(got.colour == want.colour);
      CHECK(got.moved_colour == want.moved_colour);
    }
}

TEST_CASE("photometric: value and gradient of a device equal the CPU's within rounding") {
  struct Case {
    int width, height;
    PixelRect box;
    bool weighted;
  };
  const Case cases[] = {{1, 1, {}, false}, {5, 40, {}, true}, {37, 29, {}, false}, {60, 45, {20, 10, 31, 25}, true}};
  for (const Backend& b : backends())
    for (const Case& c : cases) {
      Random random(4);
      const ImageF x = random_image(random, c.width, c.height, 3), y = random_image(random, c.width, c.height, 3),
                   weight = random_image(random, c.width, c.height, 1);
      const PhotometricOptions options{0.2, c.box};
      ImageF want_grad, got_grad;
      PhotometricPass<float> pass;
      const auto want = pass.evaluate({}, options, {x, y, c.weighted ? &weight : nullptr}, &want_grad),
                 got = pass.evaluate(b.exec, options, {x, y, c.weighted ? &weight : nullptr}, &got_grad);
      CAPTURE(c.width);
      check_ratio(b, "photometric loss", relative(got.total, want.total), 1e-3);
      CHECK(got_grad.data == want_grad.data);  // sums, products and quotients in the same order
      CHECK(pass.evaluate(b.exec, options, {x, y, c.weighted ? &weight : nullptr}, nullptr).total == got.total);
    }
}

TEST_CASE("adam: a step of a device equals the CPU's bit for bit") {
  for (const Backend& b : backends())
    for (const int columns : {0, 2})
      for (const std::size_t n : {std::size_t(2), std::size_t(700), std::size_t(300000)}) {
        if (n > 1000 && &b != &backends()[0]) continue;
        Random random(5);
        auto want = random.uniform_vector<float>(n, -1, 1), grad = random.uniform_vector<float>(n, -1, 1);
        for (std::size_t i = 0; i + 1 < n; i += 6) grad[i] = grad[i + 1] = 0;  // whole rows of two
        auto got = want;
        AdamMoments want_moments, got_moments;
        AdamOptions options{.sparse_columns = columns};
        for (std::int64_t step = 1; step <= 3; ++step) {
          adam_step({}, options, step, {"x", want, grad}, want_moments);
          adam_step(b.exec, options, step, {"x", got, grad}, got_moments);
        }
        CHECK(got == want);
        CHECK(got_moments.m == want_moments.m);
        CHECK(got_moments.v == want_moments.v);
        std::fill(grad.begin() + std::ptrdiff_t(n / 2), grad.end(), NAN);
        grad[n / 2] = -INFINITY;  // the first bad index is reported
        std::string message;
        try {
          adam_step(b.exec, options, 4, {"x", got, grad}, got_moments);
        } catch (const Error& e) {
          message = e.what();
        }
        CHECK(message.find("x: gradient " + std::to_string(n / 2) + " ") == 0);
        CHECK(got == want);  // unchanged
      }
}

}  // namespace ngs::test
