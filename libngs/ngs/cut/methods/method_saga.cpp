#include "ngs/cut/methods/method_saga.h"

#include <algorithm>

#include "ngs/core/rng.h"
#include "ngs/cut/evidence/method_labels.h"
#include "ngs/ops/neighbours/knn.h"
#include "ngs/problem/cloud_rows.h"
#include "ngs/scene/mask_threshold.h"

namespace ngs {
namespace {

constexpr double kShortest = 1e-3;  // least length of a rendered feature whose direction is used

struct PairCounts {
  double same = 0, different = 0;
};

PairCounts count_pairs(std::span<const int> id, const std::vector<double>& length) {
  std::vector<double> of(std::size_t(*std::max_element(id.begin(), id.end())) + 1, 0.0);
  double all = 0, squares = 0;
  PairCounts pairs;
  for (std::size_t i = 0; i < id.size(); ++i)
    if (length[i] >= kShortest) {
      ++of[std::size_t(id[i])];
      ++all;
    }
  for (std::size_t k = 0; k < of.size(); ++k) {
    squares += of[k] * of[k];
    if (k > 0) pairs.same += of[k] * (of[k] - 1) / 2;
  }
  pairs.different = (all * all - squares) / 2;
  return pairs;
}

/// Object ids of a feature image's pixels: 0 background, k + 1 object k, -1 unknown. Nearest mask pixel.
std::vector<int> pixel_ids(const ViewMasks& masks, int width_px, int height_px) {
  std::vector<int> id;
  for (int y = 0; y < height_px; ++y)
    for (int x = 0; x < width_px; ++x) {
      const auto column = std::size_t((x + 0.5) * masks.width_px / width_px),
                 row = std::size_t((y + 0.5) * masks.height_px / height_px);
      const std::size_t p = row * std::size_t(masks.width_px) + column;
      int found = masks.known.empty() || masks.known[p] ? 0 : -1;
      for (std::size_t k = masks.target.size(); found >= 0 && k-- > 0;)
        if (mask_is_foreground(masks.target[k][p])) found = int(k) + 1;
      id.push_back(found);
    }
  return id;
}

constexpr int kNeighbours = 16;  // number of Gaussians in the mean of a smoothed feature

class Saga {
 public:
  Saga(const Exec& exec, const SagaOptions& options, const Problem& input)
      : options_(options), input_(input), pass_(input.splat) {
    std::vector<CloudRow> rows;
    for (std::int64_t i = 0; i < input.cloud.size(); ++i)
      if (input.cloud.usable[std::size_t(i)]) {
        rows.push_back({i, RowOrigin::kKept});
        row_.push_back(std::size_t(i));
      }
    cloud_ = input.cloud;
    edit_rows(exec, rows, 0, cloud_);
    const Rows<const float, 3> points{cloud_.position.data(), cloud_.size()};
    graph_ = nearest_points(exec, points, points, kNeighbours);  // includes the point itself
    build_transpose(graph_);
    features_.resize(rows.size() * std::size_t(options.dims));
    for (std::size_t i = 0; i < features_.size(); ++i)
      features_[i] = float(rng_normal(input.seed, RngStream::kSaga, i));
    for (std::size_t i = 0; i < features_.size(); ++i) features_[i] /= std::sqrt(float(options.dims));
  }

  void train(const Exec& exec, Monitor& monitor) {
    SmoothedFeatures<float> smooth(graph_, options_.dims);
    std::vector<float> u, grad_features;
    for (; step_ < options_.steps && !monitor.stop_requested(); ++step_) {
      const std::size_t view = input_.views[std::size_t(draw(0) % input_.views.size())];
      const std::vector<int>& id = ids_of(view);
      if (id.empty()) continue;
      smooth.forward(exec, features_, drawn_slots(), u);
      const ImageF& image = rendered(exec, view, u);
      const std::vector<std::size_t> pixel = drawn_pixels(id);
      if (pixel.empty()) continue;
      loss_ = backward_pixels(exec, image, pixel);
      pass_.backward(exec, image_gradient_, gradients_);
      smooth.backward(exec, features_, u, gradients_.label, grad_features);
      adam_step(exec, {.lr = options_.lr}, ++updates_, {"affinity feature", features_, grad_features}, moments_);
      monitor.progress(step_ + 1, options_.steps);
    }
  }

  /// [N] cosine between a Gaussian's feature and the prototype of object k; 0 for unusable ones.
  std::vector<float> cosines(const Exec& exec, int object) {
    SmoothedFeatures<float> smooth(graph_, options_.dims);
    std::vector<float> u;
    smooth.forward(exec, features_, std::vector<std::uint8_t>(std::size_t(graph_.neighbours), 1), u);
    const std::vector<double> prototype = prototype_of(exec, object, u);
    std::vector<float> out(std::size_t(input_.cloud.size()), 0.f);
    for (std::size_t i = 0; i < row_.size(); ++i)
      for (std::size_t c = 0; c < prototype.size(); ++c)
        out[row_[i]] += float(prototype[c] * double(u[i * prototype.size() + c]));
    return out;
  }

  double loss() const { return loss_; }
  std::int64_t updates() const { return updates_; }

 private:
  std::uint64_t draw(std::uint64_t what) const {
    return rng_bits(input_.seed, RngStream::kSaga, (std::uint64_t(step_) + 1) << 32 | what);
  }

  /// A random half of the neighbour slots, at least one.
  std::vector<std::uint8_t> drawn_slots() const {
    std::vector<std::uint8_t> used(std::size_t(graph_.neighbours), 0);
    std::vector<std::size_t> order(used.size());
    for (std::size_t s = 0; s < order.size(); ++s) order[s] = s;
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return draw(1 + a) < draw(1 + b); });
    for (std::size_t s = 0; s < (used.size() + 1) / 2; ++s) used[order[s]] = 1;
    return used;
  }

  /// Half of the pixels from objects, half from the background, with replacement; fills id_. Empty without an object.
  std::vector<std::size_t> drawn_pixels(const std::vector<int>& id) {
    std::vector<std::size_t> group[2], pixel;
    for (std::size_t p = 0; p < id.size(); ++p)
      if (id[p] >= 0) group[id[p] > 0].push_back(p);
    id_.clear();
    if (group[1].empty()) return pixel;
    for (int i = 0; i < options_.pixels; ++i) {
      const auto& from = group[i % 2 == 0 || group[0].empty()];
      pixel.push_back(from[std::size_t(draw(64 + std::uint64_t(i)) % from.size())]);
      id_.push_back(id[pixel.back()]);
    }
    return pixel;
  }

  Camera feature_camera(std::size_t view) const {
    const Camera& full = input_.scene.views[view].camera;
    const double s = options_.image_scale;
    return resized(full, scaled_size_px(full.width_px, s), scaled_size_px(full.height_px, s));
  }

  /// Ids at the size of the feature images, cached; empty if the view has no masks.
  const std::vector<int>& ids_of(std::size_t view) {
    const auto [at, is_new] = ids_.try_emplace(view);
    if (is_new) {
      const ViewMasks masks = input_.load_masks(view);
      const Camera camera = feature_camera(view);
      if (masks.available) at->second = pixel_ids(masks, camera.width_px, camera.height_px);
    }
    return at->second;
  }

  const ImageF& rendered(const Exec& exec, std::size_t view, const std::vector<float>& u) {
    RenderRequest request{.colour = false, .label = {u.data(), cloud_.size(), options_.dims}};
    return pass_.forward(exec, cloud_, feature_camera(view), request).label;
  }

  double backward_pixels(const Exec& exec, const ImageF& image, const std::vector<std::size_t>& pixel) {
    const auto d = std::size_t(options_.dims);
    std::vector<float> feature, grad;
    for (const std::size_t p : pixel)
      feature.insert(feature.end(), image.data.begin() + std::ptrdiff_t(p * d),
                     image.data.begin() + std::ptrdiff_t((p + 1) * d));
    const double loss = contrastive_loss(exec, options_.dims, feature, id_, grad);
    image_gradient_.label = ImageF(image.width_px, image.height_px, options_.dims);
    for (std::size_t i = 0; i < pixel.size(); ++i)
      for (std::size_t c = 0; c < d; ++c) image_gradient_.label.data[pixel[i] * d + c] += grad[i * d + c];
    return loss;
  }

  /// The training view with the most pixels of the object.
  std::size_t reference_view(int object) {
    std::size_t best = input_.views.front();
    std::int64_t most = -1;
    for (const std::size_t view : input_.views) {
      const std::vector<int>& id = ids_of(view);
      const std::int64_t count = std::count(id.begin(), id.end(), object + 1);
      if (count > most) {
        most = count;
        best = view;
      }
    }
    return best;
  }

  std::vector<double> prototype_of(const Exec& exec, int object, const std::vector<float>& u) {
    const std::size_t view = reference_view(object), d = std::size_t(options_.dims);
    const ImageF& image = rendered(exec, view, u);
    std::vector<double> mean(d, 0.0);
    const std::vector<int>& id = ids_of(view);
    double square = 0;
    for (std::size_t p = 0; p < id.size(); ++p)
      if (id[p] == object + 1)
        for (std::size_t c = 0; c < d; ++c) mean[c] += double(image.data[p * d + c]);
    for (const double m : mean) square += m * m;
    for (double& m : mean) m /= square > 0 ? std::sqrt(square) : 1;
    return mean;
  }

  const SagaOptions& options_;
  const Problem& input_;
  GaussianCloud cloud_;           // the usable Gaussians
  std::vector<std::size_t> row_;  // rows of the input cloud
  KnnGraph graph_;
  std::vector<float> features_;  // [usable, D]
  AdamMoments moments_;
  std::map<std::size_t, std::vector<int>> ids_;
  std::vector<int> id_;  // ids of the pixels drawn last
  SplatPass pass_;
  CloudGradients gradients_;
  ViewGradients image_gradient_;
  std::int64_t step_ = 0, updates_ = 0;
  double loss_ = 0;
};

}  // namespace

double contrastive_loss(const Exec& exec, int dims, std::span<const float> features, std::span<const int> id,
                        std::vector<float>& grad) {
  const auto d = std::size_t(dims), n = id.size();
  grad.assign(features.size(), 0.f);
  if (n == 0) return 0;
  std::vector<double> unit(features.size(), 0.0), length(n), row_loss(n);
  double mean_length = 0;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t c = 0; c < d; ++c) length[i] += double(features[i * d + c]) * double(features[i * d + c]);
    length[i] = std::sqrt(length[i]);
    mean_length += length[i] / double(n);
    if (length[i] > 0)
      for (std::size_t c = 0; c < d; ++c) unit[i * d + c] = double(features[i * d + c]) / length[i];
  }
  const PairCounts pairs = count_pairs(id, length);
  const double same = pairs.same > 0 ? 1 / pairs.same : 0, different = pairs.different > 0 ? 1 / pairs.different : 0;
  for_each_index(exec, std::int64_t(n), [&](std::int64_t row) {
    const auto i = std::size_t(row);
    std::vector<double> g(d, 0.0);
    const double* a = &unit[i * d];
    for (std::size_t j = 0; j < n && length[i] >= kShortest; ++j) {
      if (j == i || length[j] < kShortest || (id[i] == 0 && id[j] == 0)) continue;
      const double* b = &unit[j * d];
      double cosine = 0;
      for (std::size_t c = 0; c < d; ++c) cosine += a[c] * b[c];
      const double factor = id[i] == id[j] ? -same : cosine > 0 ? different : 0.0;
      row_loss[i] += 0.5 * factor * cosine;  // every pair is visited from both sides
      for (std::size_t c = 0; c < d; ++c) g[c] += factor * b[c];
    }
    double along = 0;
    for (std::size_t c = 0; c < d; ++c) along += g[c] * a[c];
    const double pull = -2 * (1 - mean_length) / double(n);
    for (std::size_t c = 0; c < d && length[i] > 0; ++c)
      grad[i * d + c] = float((g[c] - along * a[c]) / length[i] + pull * a[c]);
  });
  double loss = (1 - mean_length) * (1 - mean_length);
  for (const double l : row_loss) loss += l;
  return loss;
}

Solution run_saga(const Exec& exec, Monitor& monitor, const SagaOptions& options, const Problem& input) {
  Solution result;
  result.cloud = unchanged(input.cloud);
  result.labels = closed_form_labels(exec, monitor, input);
  if (input.views.empty())
    throw Error(ErrorCode::kInconsistent, "saga: no training view, expected at least one", "hold out fewer views");
  const auto timed = monitor.scope("saga");
  Saga saga(exec, options, input);
  saga.train(exec, monitor);
  std::vector<std::vector<float>> cosine;
  for (int k = 0; k < int(result.labels.size()); ++k) cosine.push_back(saga.cosines(exec, k));
  for (std::size_t i = 0; i < std::size_t(input.cloud.size()); ++i) {
    std::size_t best = 0;
    for (std::size_t k = 1; k < cosine.size(); ++k)
      if (cosine[k][i] > cosine[best][i]) best = k;
    for (std::size_t k = 0; k < cosine.size(); ++k) {
      LabelColumns& c = result.labels[k];
      if (c.views[i] == 0) continue;
      c.prob[i] = std::clamp(cosine[k][i], 0.f, 1.f);
      c.label[i] = float(k == best && double(cosine[k][i]) > options.threshold);
    }
  }
  restore_fixed(input, {}, result.labels);
  for (const LabelColumns& c : result.labels) result.figures["object_gaussians"] += labelled_count(c);
  result.figures["steps"] = double(saga.updates());
  result.figures["loss"] = saga.loss();
  result.converged = !monitor.stop_requested();
  return result;
}

}  // namespace ngs
