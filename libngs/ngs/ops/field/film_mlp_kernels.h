#pragma once
// The FiLM-modulated network on one block of queries.                                     Eqs. (12)-(15)
//
//   h_0 = ReLU(W_0 f + b_0)         h_l = W_l x_l + b_l   for l > 0          (C21: one ReLU per layer)
//   x_{l+1} = ReLU(γ_l ⊙ h_l + β_l),   γ_l = W_γ c + b_γ,   β_l = W_β c + b_β     at every layer
//   density = scale · softplus(w_d · x_n + b_d)                   world^-1
//   rgb = sigmoid(W_c x_n + W_dir Y(d) + b_c)
//
// One lane per query; a block is kBlockColumns<L> queries, one column each in every buffer. The backward pass
// recomputes γ, β and x: this costs a tenth of a layer and saves their memory traffic.
#include <utility>
#include <vector>

#include "ngs/math/sh.h"
#include "ngs/math/stable.h"
#include "ngs/ops/field/film_gemm_kernels.h"
#include "ngs/ops/field/film_mlp_layout.h"
#include "ngs/scene/views.h"

namespace ngs {

/// Inputs and outputs for all Q queries. S = scalar of the lanes.
template <class S>
struct FilmMlpData {
  const S* params = nullptr;   // FilmMlpLayout
  Matrix<const S> input;       // [Q, inputs]     f_hash
  Matrix<const S> condition;   // [Q, condition]  f_inter
  Rows<const S, 3> direction;  // [Q / queries_per_direction, 3] unit; n = 0 if the network takes none
  std::int64_t queries_per_direction = 1;
  S density_scale = S(1);  // world^-1
  S* density = nullptr;    // [Q]     out
  S* rgb = nullptr;        // [Q, 3]  out
};

/// In: ∂L/∂outputs; out: ∂L/∂inputs (null: not wanted).
template <class S>
struct FilmMlpGrads {
  const S* density = nullptr;  // [Q]
  const S* rgb = nullptr;      // [Q, 3]
  S* input = nullptr;          // [Q, inputs]
  S* condition = nullptr;      // [Q, condition]
};

/// Scalars per block that forward stores for backward: h of every layer and the four raw outputs.
template <class L>
std::size_t film_context_size(const FilmMlpConfig& c) {
  return std::size_t(c.layers * c.hidden + 4) * std::size_t(kBlockColumns<L>);
}

template <class L>
class FilmMlpBlock {
 public:
  using S = typename LaneTraits<L>::Scalar;
  static constexpr int kColumns = kBlockColumns<L>;

  explicit FilmMlpBlock(const FilmMlpConfig& config)
      : c_(config), at_(film_mlp_layout(config)), direction_inputs_(film_direction_inputs(config)) {
    widest_ = c_.hidden > c_.inputs ? c_.hidden : c_.inputs;
    for (std::vector<S>* v : {&x_, &gamma_, &beta_, &grad_x_, &grad_h_}) v->resize(plane(widest_));
    in_.resize(plane(c_.inputs));
    condition_.resize(plane(c_.condition));
    grad_condition_.resize(plane(c_.condition));
    direction_.resize(plane(direction_inputs_));
    raw_.resize(plane(4));
    head_.resize(plane(3));
    transposed_.resize(std::size_t(widest_) * std::size_t(c_.hidden));
    partial_.resize(plane(c_.condition));
  }

  /// Processes queries [block · kColumns, ...) of `data`; columns beyond the last query are computed on zeros and
  /// dropped. `context`: the block's film_context_size scalars, out.
  void forward(const FilmMlpData<S>& data, std::int64_t block, S* context) {
    load_block(data, block);
    S* h = context;
    for (int l = 0; l < c_.layers; ++l, h += plane(c_.hidden)) {
      const FilmMlpLayout::Layer& layer = at_.layer[l];
      const S* p = data.params;
      lanes_product<L>({p + layer.weight, c_.hidden, layer.inputs}, l == 0 ? in_.data() : x_.data(), p + layer.bias, h);
      if (l == 0) relu_in_place(h);
      modulate(p, l, h);
    }
    S* raw = h;
    lanes_product<L>({data.params + at_.head_weight, 4, c_.hidden}, x_.data(), data.params + at_.head_bias, raw);
    if (direction_inputs_ > 0) {
      lanes_product<L>({data.params + at_.direction_weight, 3, direction_inputs_}, direction_.data(),
                       static_cast<const S*>(nullptr), head_.data());
      for (int i = 0; i < 3 * kColumns; ++i) raw[kColumns + i] += head_[std::size_t(i)];
    }
    const int count = columns_used(data, block);
    for (int q = 0; q < count; ++q) {
      const std::int64_t query = block * kColumns + q;
      data.density[query] = data.density_scale * softplus(raw[q]);
      for (int ch = 0; ch < 3; ++ch) data.rgb[query * 3 + ch] = sigmoid(raw[(1 + ch) * kColumns + q]);
    }
  }

  /// Adjoint of forward. Adds the block's part to `grad_params_accumulate` [FilmMlpLayout::size].
  void backward(const FilmMlpData<S>& data, const FilmMlpGrads<S>& grads, std::int64_t block, const S* context,
                S* grad_params_accumulate) {
    load_block(data, block);
    const S* p = data.params;
    S* g = grad_params_accumulate;
    load_raw_gradient(data, grads, block, context + plane(c_.layers * c_.hidden));
    zero(grad_condition_);
    modulate(p, c_.layers - 1, context + plane((c_.layers - 1) * c_.hidden));  // x_n
    lanes_outer_accumulate<L>(raw_.data(), 4, x_.data(), c_.hidden, g + at_.head_weight);
    lanes_row_sums_accumulate<L>(raw_.data(), 4, g + at_.head_bias);
    if (direction_inputs_ > 0)
      lanes_outer_accumulate<L>(raw_.data() + kColumns, 3, direction_.data(), direction_inputs_,
                                g + at_.direction_weight);
    product_transposed(p + at_.head_weight, 4, c_.hidden, raw_.data(), grad_x_.data());

    for (int l = c_.layers - 1; l >= 0; --l) {
      const FilmMlpLayout::Layer& layer = at_.layer[l];
      backward_modulation(p, l, context + plane(l * c_.hidden), g);
      if (l > 0) modulate(p, l - 1, context + plane((l - 1) * c_.hidden));  // recompute x_l
      const S* x = l == 0 ? in_.data() : x_.data();
      lanes_outer_accumulate<L>(grad_h_.data(), c_.hidden, x, layer.inputs, g + layer.weight);
      lanes_row_sums_accumulate<L>(grad_h_.data(), c_.hidden, g + layer.bias);
      if (l > 0 || grads.input != nullptr)
        product_transposed(p + layer.weight, c_.hidden, layer.inputs, grad_h_.data(), grad_x_.data());
    }
    store_rows(grads.input, grad_x_.data(), c_.inputs, data, block);
    store_rows(grads.condition, grad_condition_.data(), c_.condition, data, block);
  }

 private:
  static std::size_t plane(int rows) { return std::size_t(rows) * std::size_t(kColumns); }
  static void zero(std::vector<S>& v) { v.assign(v.size(), S(0)); }

  int columns_used(const FilmMlpData<S>& data, std::int64_t block) const {
    const std::int64_t left = data.input.n - block * kColumns;
    return int(left < kColumns ? left : kColumns);
  }

  /// Transposes query rows to columns; unused columns are zero.
  void load_block(const FilmMlpData<S>& data, std::int64_t block) {
    const int count = columns_used(data, block);
    load_rows(data.input, block, count, in_);
    load_rows(data.condition, block, count, condition_);
    if (direction_inputs_ == 0) return;
    zero(direction_);
    S basis[15];
    std::int64_t previous = -1;
    for (int q = 0; q < count; ++q) {
      const std::int64_t ray = (block * kColumns + q) / data.queries_per_direction;
      if (ray != previous) sh_rest_basis(c_.direction_degree, vec3(data.direction.row(ray)), basis);
      previous = ray;
      for (int i = 0; i < direction_inputs_; ++i) direction_[std::size_t(i * kColumns + q)] = basis[i];
    }
  }
  static void load_rows(Matrix<const S> rows, std::int64_t block, int count, std::vector<S>& columns) {
    if (count < kColumns) zero(columns);
    for (int q = 0; q < count; ++q) {
      const S* row = rows.row(block * kColumns + q);
      for (int i = 0; i < rows.c; ++i) columns[std::size_t(i * kColumns + q)] = row[i];
    }
  }
  void store_rows(S* rows, const S* columns, int width, const FilmMlpData<S>& data, std::int64_t block) const {
    if (rows == nullptr) return;
    const int count = columns_used(data, block);
    for (int q = 0; q < count; ++q)
      for (int i = 0; i < width; ++i) rows[(block * kColumns + q) * width + i] = columns[i * kColumns + q];
  }

  /// body(offset) for every pack of a hidden activation.
  template <class Body>
  void each_pack(const Body& body) const {
    for (std::size_t i = 0; i < plane(c_.hidden); i += LaneTraits<L>::kLanes) body(i);
  }
  static L load(const S* p) {
    L x;
    load_lanes(p, x);
    return x;
  }
  static L relu(L x) { return select(x < L(S(0)), L(S(0)), x); }  // keeps NaN

  void relu_in_place(S* h) const {
    each_pack([h](std::size_t i) { store_lanes(h + i, relu(load(h + i))); });
  }

  /// gamma_, beta_ of layer l, and x_ = ReLU(γ h + β).
  void modulate(const S* p, int l, const S* h) {
    const FilmMlpLayout::Layer& layer = at_.layer[l];
    lanes_product<L>({p + layer.gamma_weight, c_.hidden, c_.condition}, condition_.data(), p + layer.gamma_bias,
                     gamma_.data());
    lanes_product<L>({p + layer.beta_weight, c_.hidden, c_.condition}, condition_.data(), p + layer.beta_bias,
                     beta_.data());
    each_pack([h, gamma = gamma_.data(), beta = beta_.data(), x = x_.data()](std::size_t i) {
      store_lanes(x + i, relu(fma_lanes(load(gamma + i), load(h + i), load(beta + i))));
    });
  }

  /// Adjoint of `modulate`, from grad_x_ to grad_h_; gamma_, beta_, x_ hold layer l. Layer 0 includes the inner ReLU.
  /// Overwrites gamma_, beta_ with ∂L/∂γ, ∂L/∂β.
  void backward_modulation(const S* p, int l, const S* h, S* g) {
    const FilmMlpLayout::Layer& layer = at_.layer[l];
    const L zero_lanes(S(0));
    each_pack([=, gamma = gamma_.data(), beta = beta_.data(), x = x_.data(), grad_x = grad_x_.data(),
               grad_h = grad_h_.data()](std::size_t i) {
      const L grad = select(load(x + i) > zero_lanes, load(grad_x + i), zero_lanes), value = load(h + i);
      const L through = grad * load(gamma + i);
      store_lanes(grad_h + i, l > 0 ? through : select(value > zero_lanes, through, zero_lanes));
      store_lanes(gamma + i, grad * value);
      store_lanes(beta + i, grad);
    });
    lanes_outer_accumulate<L>(gamma_.data(), c_.hidden, condition_.data(), c_.condition, g + layer.gamma_weight);
    lanes_row_sums_accumulate<L>(gamma_.data(), c_.hidden, g + layer.gamma_bias);
    lanes_outer_accumulate<L>(beta_.data(), c_.hidden, condition_.data(), c_.condition, g + layer.beta_weight);
    lanes_row_sums_accumulate<L>(beta_.data(), c_.hidden, g + layer.beta_bias);
    for (const auto& [weight, grad] : {std::pair{layer.gamma_weight, &gamma_}, {layer.beta_weight, &beta_}}) {
      product_transposed(p + weight, c_.hidden, c_.condition, grad->data(), partial_.data());
      for (std::size_t i = 0; i < partial_.size(); ++i) grad_condition_[i] += partial_[i];
    }
  }

  /// y [cols, columns] = wᵀ u for w [rows, cols].
  void product_transposed(const S* w, int rows, int cols, const S* u, S* y) {
    for (int r = 0; r < rows; ++r)
      for (int c = 0; c < cols; ++c) transposed_[std::size_t(c * rows + r)] = w[r * cols + c];
    lanes_product<L>({transposed_.data(), cols, rows}, u, static_cast<const S*>(nullptr), y);
  }

  /// raw_ = ∂L/∂(the four raw outputs).
  void load_raw_gradient(const FilmMlpData<S>& data, const FilmMlpGrads<S>& grads, std::int64_t block, const S* raw) {
    zero(raw_);
    const int count = columns_used(data, block);
    for (int q = 0; q < count; ++q) {
      const std::int64_t query = block * kColumns + q;
      raw_[std::size_t(q)] = grads.density[query] * data.density_scale * sigmoid(raw[q]);
      for (int ch = 0; ch < 3; ++ch)
        raw_[std::size_t((1 + ch) * kColumns + q)] =
            grads.rgb[query * 3 + ch] * sigmoid_slope(raw[(1 + ch) * kColumns + q]);
    }
  }

  FilmMlpConfig c_;
  FilmMlpLayout at_;
  int direction_inputs_, widest_;
  std::vector<S> in_, condition_, direction_;  // inputs of the block, [features, columns]
  std::vector<S> x_, gamma_, beta_;            // of the current layer
  std::vector<S> grad_x_, grad_h_, grad_condition_, partial_, raw_, head_;
  std::vector<S> transposed_;
};

}  // namespace ngs
