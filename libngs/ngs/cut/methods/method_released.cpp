#include "ngs/cut/methods/method_released.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "ngs/backend/for_each.h"
#include "ngs/core/rng.h"
#include "ngs/cut/methods/method_cob.h"
#include "ngs/math/sh.h"
#include "ngs/math/stable.h"
#include "ngs/ops/neighbours/knn.h"
#include "ngs/ops/optim/adam.h"

namespace ngs {
namespace {

constexpr int kLevels = 8, kFeatures = 2, kInputs = kLevels * kFeatures + 3, kHidden = 64, kHeads = 4, kNeighbours = 8;
constexpr std::size_t kTable = 1u << 15;
constexpr double kTint = 0.1, kBaseShare = 0.25, kJitter = 0.01, kMinWeight = 1e-6;
constexpr std::int64_t kChunk = 256;  // rows per task of the backward pass

// Parameters: tables, then weight and bias of each layer.
constexpr std::size_t kTables = kLevels * kTable * kFeatures;
constexpr std::size_t kW1 = 0, kB1 = kW1 + kHidden * kInputs, kW2 = kB1 + kHidden, kB2 = kW2 + kHidden * kHidden,
                      kGammaW = kB2 + kHidden, kGammaB = kGammaW + kHidden * 3, kBetaW = kGammaB + kHidden,
                      kBetaB = kBetaW + kHidden * 3, kHeadW = kBetaB + kHidden, kHeadB = kHeadW + kHeads * kHidden,
                      kNetwork = kHeadB + kHeads;

/// y = W x + b and its adjoint. `weight` and `bias` are offsets into the parameters of the network.
struct Affine {
  std::size_t weight, bias;
  int rows, columns;

  void forward(const double* net, const double* x, double* y) const {
    const double *w = net + weight, *b = net + bias;
    for (int r = 0; r < rows; ++r) {
      double sum = b[r];
      for (int c = 0; c < columns; ++c) sum += w[r * columns + c] * x[c];
      y[r] = sum;
    }
  }
  /// Adds to the gradients of the parameters and of x.
  void backward(const double* net, const double* x, const double* grad_y, double* grad, double* grad_x) const {
    const double* w = net + weight;
    double *gw = grad + weight, *gb = grad + bias;
    for (int r = 0; r < rows; ++r) {
      gb[r] += grad_y[r];
      for (int c = 0; c < columns; ++c) {
        gw[r * columns + c] += grad_y[r] * x[c];
        grad_x[c] += w[r * columns + c] * grad_y[r];
      }
    }
  }
};
constexpr Affine kLayer1{kW1, kB1, kHidden, kInputs}, kLayer2{kW2, kB2, kHidden, kHidden},
    kGamma{kGammaW, kGammaB, kHidden, 3}, kBeta{kBetaW, kBetaB, kHidden, 3}, kHead{kHeadW, kHeadB, kHeads, kHidden};

/// Values of one row's forward pass that its backward pass reads.
struct RowState {
  double in[kInputs], a1[kHidden], a2[kHidden], gamma[kHidden], beta[kHidden], film[kHidden], h3[kHidden], head[kHeads];
};

struct RowOutput {
  double rgb[3], density;
};

double relu(double x) { return x > 0 ? x : 0; }

/// `net`: the parameters that follow the hash tables. Reads s.in, writes all other members of `s`.
RowOutput forward_row(const double* net, RowState& s) {
  const double* base = s.in + kLevels * kFeatures;
  double h1[kHidden], h2[kHidden];
  kLayer1.forward(net, s.in, s.a1);
  for (int i = 0; i < kHidden; ++i) h1[i] = relu(s.a1[i]);
  kLayer2.forward(net, h1, s.a2);
  kGamma.forward(net, base, s.gamma);
  kBeta.forward(net, base, s.beta);
  for (int i = 0; i < kHidden; ++i) {
    h2[i] = relu(s.a2[i]);
    s.film[i] = (1 + s.gamma[i]) * h2[i] + s.beta[i];
    s.h3[i] = relu(s.film[i]);
  }
  kHead.forward(net, s.h3, s.head);
  RowOutput out;
  for (int c = 0; c < 3; ++c) out.rgb[c] = std::clamp(base[c] + kTint * std::tanh(s.head[c]), 0.0, 1.0);
  out.density = softplus(s.head[3]);
  return out;
}

/// Adds to `grad` (network) and overwrites `grad_in` with ∂L/∂in; its last three values are those of the base colour.
void backward_row(const double* net, const RowState& s, const RowOutput& g, double* grad, double* grad_in) {
  const double* base = s.in + kLevels * kFeatures;
  std::fill_n(grad_in, kInputs, 0.0);
  double* grad_base = grad_in + kLevels * kFeatures;
  double g_head[kHeads], g3[kHidden] = {}, g_gamma[kHidden], g_film[kHidden], g2[kHidden] = {}, g1[kHidden] = {},
                         h1[kHidden];
  for (int c = 0; c < 3; ++c) {
    const double t = std::tanh(s.head[c]), raw = base[c] + kTint * t, through = raw > 0 && raw < 1 ? g.rgb[c] : 0;
    grad_base[c] += through;
    g_head[c] = through * kTint * (1 - t * t);
  }
  g_head[3] = g.density * sigmoid(s.head[3]);
  kHead.backward(net, s.h3, g_head, grad, g3);
  for (int i = 0; i < kHidden; ++i) {
    g_film[i] = s.film[i] > 0 ? g3[i] : 0;
    g_gamma[i] = g_film[i] * relu(s.a2[i]);
    g2[i] = s.a2[i] > 0 ? g_film[i] * (1 + s.gamma[i]) : 0;
    h1[i] = relu(s.a1[i]);
  }
  kGamma.backward(net, base, g_gamma, grad, grad_base);
  kBeta.backward(net, base, g_film, grad, grad_base);
  kLayer2.backward(net, h1, g2, grad, g1);
  for (int i = 0; i < kHidden; ++i) g1[i] = s.a1[i] > 0 ? g1[i] : 0;
  kLayer1.backward(net, s.in, g1, grad, grad_in);
}

/// Table entry of every (row, level): the floor cell of the coordinates, scaled to the bounds of the batch.
std::vector<std::uint32_t> hash_cells(const std::vector<double>& position) {
  const std::size_t rows = position.size() / 3;
  double lo[3] = {INFINITY, INFINITY, INFINITY}, hi[3] = {-INFINITY, -INFINITY, -INFINITY};
  for (std::size_t i = 0; i < position.size(); ++i) {
    lo[i % 3] = std::min(lo[i % 3], position[i]);
    hi[i % 3] = std::max(hi[i % 3], position[i]);
  }
  std::vector<std::uint32_t> entry(rows * kLevels);
  for (std::size_t r = 0; r < rows; ++r)
    for (std::size_t l = 0; l < kLevels; ++l) {
      const double resolution = std::floor(16 * std::pow(32.0, double(l) / (kLevels - 1)));
      std::uint64_t cell[3];
      for (std::size_t k = 0; k < 3; ++k) {
        const double extent = std::max(hi[k] - lo[k], 1e-6);
        cell[k] = std::uint64_t((position[r * 3 + k] - lo[k]) / extent * resolution);
      }
      const std::uint64_t hash = (cell[0] * 1540863) ^ (cell[1] * 1251391) ^ (cell[2] * 1987613);
      entry[r * kLevels + l] = std::uint32_t(l * kTable + hash % kTable);
    }
  return entry;
}

/// The network over a batch: outputs, then gradients from `grad_out`.
struct Batch {
  const std::vector<double>& value;
  const std::vector<double>& base;
  std::vector<std::uint32_t> entry;
  std::vector<RowState> state;
  std::vector<RowOutput> out;

  Batch(const Exec& exec, const std::vector<double>& parameters, const std::vector<double>& position,
        const std::vector<double>& colours)
      : value(parameters),
        base(colours),
        entry(hash_cells(position)),
        state(colours.size() / 3),
        out(colours.size() / 3) {
    for_each_index(exec, std::int64_t(state.size()), [&](std::int64_t row) {
      const auto r = std::size_t(row);
      for (std::size_t l = 0; l < kLevels; ++l)
        for (std::size_t f = 0; f < kFeatures; ++f)
          state[r].in[l * kFeatures + f] = value[entry[r * kLevels + l] * kFeatures + f];
      std::copy_n(&base[r * 3], 3, state[r].in + kLevels * kFeatures);
      out[r] = forward_row(value.data() + kTables, state[r]);
    });
  }

  /// Adds to `grad` (of all parameters) and `grad_base`.
  void backward(const Exec& exec, const std::vector<RowOutput>& grad_out, std::vector<double>& grad,
                std::vector<double>& grad_base) const {
    const auto rows = std::int64_t(state.size()), chunks = (rows + kChunk - 1) / kChunk;
    std::vector<double> part(std::size_t(chunks) * kNetwork, 0.0), grad_in(std::size_t(rows) * kInputs);
    for_each_task(exec, chunks, [&](std::int64_t chunk) {
      for (std::int64_t r = chunk * kChunk; r < std::min(rows, (chunk + 1) * kChunk); ++r)
        backward_row(value.data() + kTables, state[std::size_t(r)], grad_out[std::size_t(r)],
                     &part[std::size_t(chunk) * kNetwork], &grad_in[std::size_t(r) * kInputs]);
    });
    for (std::size_t i = 0; i < part.size(); ++i) grad[kTables + i % kNetwork] += part[i];
    // One task per level: the gradient of its table is summed in row order.
    for_each_task(exec, kLevels, [&](std::int64_t level) {
      for (std::size_t r = 0; r < state.size(); ++r)
        for (std::size_t f = 0; f < kFeatures; ++f) {
          const std::size_t l = std::size_t(level);
          grad[entry[r * kLevels + l] * kFeatures + f] += grad_in[r * kInputs + l * kFeatures + f];
        }
    });
    for (std::size_t i = 0; i < grad_base.size(); ++i)
      grad_base[i] += grad_in[i / 3 * kInputs + kLevels * kFeatures + i % 3];
  }
};

/// RBF weights of each row's nearest neighbours: exp(-d² / 2σ²) / max(sum, 1e-6), where σ is the mean distance.
std::vector<double> rbf_weights(const KnnGraph& graph) {
  const double sigma = std::max(mean_spacing(graph), 1e-12);
  const auto k = std::size_t(graph.neighbours);
  std::vector<double> weight(graph.index.size());
  for (std::size_t i = 0; i < std::size_t(graph.queries()); ++i) {
    double sum = 0;
    for (std::size_t s = i * k; s < (i + 1) * k; ++s)
      sum += weight[s] = std::exp(-double(graph.dist2[s]) / (2 * sigma * sigma));
    for (std::size_t s = i * k; s < (i + 1) * k; ++s) weight[s] /= std::max(sum, kMinWeight);
  }
  return weight;
}

/// Returns mean_i Σ_j w_ij |base_i - base_j|² / 3 and adds its gradient; overwrites `rbf` with every row's RBF colour.
double continuity(const KnnGraph& graph, const std::vector<double>& base, double factor, std::vector<double>& rbf,
                  std::vector<double>& grad_base) {
  const std::vector<double> weight = rbf_weights(graph);
  const double scale = 1 / double(base.size());
  double loss = 0;
  rbf.assign(base.size(), 0.0);
  for (std::size_t s = 0; s < weight.size(); ++s) {
    const std::size_t i = s / std::size_t(graph.neighbours), j = graph.index[s];
    for (std::size_t c = 0; c < 3; ++c) {
      const double d = base[i * 3 + c] - base[j * 3 + c], g = 2 * factor * scale * weight[s] * d;
      rbf[i * 3 + c] += weight[s] * base[j * 3 + c];
      loss += scale * weight[s] * d * d;
      grad_base[i * 3 + c] += g;
      grad_base[j * 3 + c] -= g;
    }
  }
  return loss;
}

std::vector<double> jittered(const std::vector<double>& position, std::uint64_t seed, std::uint64_t draw) {
  const double n = double(position.size()) / 3;
  std::array<double, 3> sum{}, square{};
  for (std::size_t i = 0; i < position.size(); ++i) sum[i % 3] += position[i] / n;
  for (std::size_t i = 0; i < position.size(); ++i)
    square[i % 3] += (position[i] - sum[i % 3]) * (position[i] - sum[i % 3]) / n;
  const double eps = kJitter * (std::sqrt(square[0]) + std::sqrt(square[1]) + std::sqrt(square[2])) / 3;
  std::vector<double> out = position;
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] += eps * rng_normal(seed, RngStream::kReleased, (draw + 1) << 24 | i);
  return out;
}

// Published weights of the colour differences to neighbours, the change under jitter, and the mean density.
constexpr double kContinuity = 0.1, kSmooth = 0.05, kDensity = 1e-3;
constexpr double kRate = 1e-3;  // Adam rate of the network and the hash tables

}  // namespace

ReleasedField::ReleasedField(std::uint64_t seed) : value_(kTables + kNetwork), seed_(seed) {
  const auto uniform = [&](std::size_t i, double bound) {
    return bound * (2 * rng_uniform(seed, RngStream::kReleased, (std::uint64_t(1) << 60) + i) - 1);
  };
  for (std::size_t i = 0; i < kTables; ++i) value_[i] = uniform(i, 1e-4);
  const auto layer = [&](std::size_t begin, std::size_t end, int inputs) {
    for (std::size_t i = begin; i < end; ++i) value_[kTables + i] = uniform(kTables + i, 1 / std::sqrt(double(inputs)));
  };
  layer(kW1, kW2, kInputs);
  layer(kW2, kGammaW, kHidden);
  layer(kGammaW, kHeadW, 3);
  layer(kHeadW, kNetwork, kHidden);
  grad_.resize(value_.size());
  m_.resize(value_.size());
  v_.resize(value_.size());
}

ReleasedLosses ReleasedField::evaluate(const Exec& exec, const ReleasedWeights& weights, const ReleasedRows& in,
                                       std::uint64_t draw, std::vector<double>& grad_base) {
  const std::vector<float>& position = in.position;
  const std::vector<double>& base = in.base;
  ReleasedLosses loss;
  std::fill(grad_.begin(), grad_.end(), 0.0);
  grad_base.assign(base.size(), 0.0);
  if (base.empty()) return loss;
  const auto rows = std::int64_t(base.size() / 3);
  const KnnGraph graph = nearest_others(exec, {position.data(), rows}, kNeighbours);
  std::vector<double> rbf;
  loss.continuity = continuity(graph, base, weights.continuity, rbf, grad_base);

  const std::vector<double> at(position.begin(), position.end());
  const Batch here(exec, value_, at, base), near(exec, value_, jittered(at, seed_, draw), base);
  std::vector<RowOutput> grad_here(std::size_t(rows), RowOutput{}), grad_near = grad_here;
  const double mean = 1 / double(base.size());
  for (std::size_t i = 0; i < std::size_t(rows); ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      const double refined = here.out[i].rgb[c], target = refined - rbf[i * 3 + c], step = refined - near.out[i].rgb[c];
      const double from_base = base[i * 3 + c] - refined;
      loss.align += mean * (target * target + kBaseShare * from_base * from_base);
      loss.smooth += mean * step * step;
      grad_here[i].rgb[c] = 2 * mean * (weights.align * target + weights.smooth * step);
      grad_near[i].rgb[c] = -2 * mean * weights.smooth * step;
      grad_base[i * 3 + c] += 2 * mean * weights.align * kBaseShare * from_base;
    }
    loss.density += here.out[i].density / double(rows);
    grad_here[i].density = weights.density / double(rows);
  }
  here.backward(exec, grad_here, grad_, grad_base);
  near.backward(exec, grad_near, grad_, grad_base);
  loss.total = weights.align * loss.align + weights.continuity * loss.continuity + weights.smooth * loss.smooth +
               weights.density * loss.density;
  return loss;
}

void ReleasedField::step(const Exec& exec, double lr) {
  adam_step(exec, {.lr = lr}, ++steps_, {"released field", value_, grad_}, {m_, v_});
}

std::vector<std::size_t> most_undecided(const GaussianCloud& cloud, const std::vector<float>& logit, int count) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < cloud.usable.size(); ++i)
    if (cloud.usable[i]) order.push_back(i);
  const std::size_t objects = cloud.usable.empty() ? 0 : logit.size() / cloud.usable.size();
  const auto least_logit = [&](std::size_t i) {  // the smallest |logit|: 4 m (1 - m) decreases with |logit|
    float least = INFINITY;
    for (std::size_t k = i * objects; k < (i + 1) * objects; ++k) least = std::min(least, std::abs(logit[k]));
    return least;
  };
  const std::size_t taken = std::min(order.size(), std::size_t(count));
  std::partial_sort(order.begin(), order.begin() + std::ptrdiff_t(taken), order.end(),
                    [&](std::size_t a, std::size_t b) {
                      const float la = least_logit(a), lb = least_logit(b);
                      return la != lb ? la < lb : a < b;
                    });
  order.resize(taken);
  std::sort(order.begin(), order.end());
  return order;
}

Solution run_released(const Exec& exec, Monitor& monitor, const ReleasedOptions& options, const Problem& input) {
  CobOptions cob = options.cob;
  cob.divisor = CobDivisor::kAll;
  const ReleasedWeights weights{options.align, kContinuity, kSmooth, kDensity};
  ReleasedField field(input.seed);
  ReleasedLosses last;
  std::uint64_t draw = 0;
  const ColourTerm regulariser = [&](const Exec& e, const GaussianCloud& cloud, const std::vector<float>& logit,
                                     std::vector<float>& grad_sh_dc) {
    const std::vector<std::size_t> rows = most_undecided(cloud, logit, options.count);
    std::vector<float> position;
    std::vector<double> base, grad_base;
    for (const std::size_t i : rows)
      for (std::size_t c = 0; c < 3; ++c) {
        position.push_back(cloud.position[i * 3 + c]);
        base.push_back(std::clamp(colour_of_dc(double(cloud.sh_dc[i * 3 + c])), 0.0, 1.0));
      }
    last = field.evaluate(e, weights, {position, base}, draw++, grad_base);
    for (std::size_t k = 0; k < base.size(); ++k)
      if (base[k] > 0 && base[k] < 1) grad_sh_dc[rows[k / 3] * 3 + k % 3] += float(kShC0 * grad_base[k]);
    field.step(e, kRate);
  };
  Solution result = run_cob_schedule(exec, monitor, cob, input, regulariser);
  result.figures["align"] = last.align;
  result.figures["continuity"] = last.continuity;
  result.figures["smooth"] = last.smooth;
  result.figures["density"] = last.density;
  return result;
}

}  // namespace ngs
