#pragma once
// Forward and backward of one whole view, templated on the storage scalar; the kernels of its tiles come as a table.
// Internal to ops: splat.cpp runs it with the float kernels of the machine, tests also with one-lane kernels of double
// and Dual<double>.
#include "ngs/ops/splat_view.h"
#include "ngs/ops/tile_scratch.h"

namespace ngs {

/// What to composite. Channels in order: rgb (if colour), the K label columns, camera z (if depth).
template <class S>
struct ChannelRequest {
  bool colour = true, depth = false;
  Matrix<const S> label;  // [N, K]
  Vec3<S> background{S(0), S(0), S(0)};
  int count() const { return (colour ? 3 : 0) + (label.n > 0 ? label.c : 0) + (depth ? 1 : 0); }
};

/// ∂L/∂(columns of CloudView); any pointer may be null (not wanted). Rows of invisible Gaussians are set to 0.
template <class S>
struct CloudGradientView {
  S *position = nullptr, *rotation = nullptr, *log_scale = nullptr, *logit_opacity = nullptr;
  S *sh_dc = nullptr, *sh_rest = nullptr, *label = nullptr, *mean_px = nullptr;
  std::uint8_t* visible = nullptr;
};

template <class S>
class SplatEngine {
 public:
  SplatEngine(const TileKernels<S>& kernels, const SplatOptions& options, const CloudView<S>& cloud,
              const Camera& camera, const ChannelRequest<S>& request)
      : kernels_(kernels), options_(options), cloud_(cloud), camera_(camera), request_(request) {
    background_.assign(std::size_t(request.count()), S(0));
    if (request.colour)
      background_[0] = request.background.x, background_[1] = request.background.y, background_[2] = request.background.z;
  }

  /// Writes channel c to out[c] and 1 - T_final to out[count()].
  void forward(const Exec& exec, const std::vector<Plane<S>>& out) {
    prepare(exec);
    composite(exec, out);
  }
  /// The two halves of forward.
  void prepare(const Exec& exec) {
    view_ = project_view(exec, cloud_, camera_, options_);
    lists_ = bin_tiles(exec, view_, camera_.width_px, camera_.height_px);
    gather_channels(exec);
  }
  void composite(const Exec& exec, const std::vector<Plane<S>>& out) const {
    for_each_task(exec, lists_.tiles(), [&](std::int64_t tile) {
      S* scratch = thread_scratch().values(std::size_t(request_.count() * kTilePixels));
      kernels_.forward({work(tile), channels(), background_.data(), out.data(), scratch});
    });
  }

  /// grad[c]: ∂L/∂(out[c] of forward), grad[count()]: ∂L/∂alpha. moves[c]: whether channel c's gradient
  /// reaches alpha, and through it the geometry.
  void backward(const Exec& exec, const std::vector<Plane<const S>>& grad, const std::vector<std::uint8_t>& moves,
                const CloudGradientView<S>& out) {
    const int columns = kPairGeometry + request_.count();
    std::vector<S> pair_grad(std::size_t(lists_.pairs()) * std::size_t(columns), S(0));
    const Matrix<S> pairs{pair_grad.data(), lists_.pairs(), columns};
    for_each_task(exec, lists_.tiles(), [&](std::int64_t tile) {
      TileScratch<S>& memory = thread_scratch();
      S* scratch = memory.values(backward_scratch(request_.count()));
      kernels_.backward({work(tile), channels(), background_.data(), grad.data(), moves.data(), pair_grad.data(), scratch,
                         &memory.tape});
    });
    clear(exec, out);
    for_each_index(exec, std::int64_t(view_.id.size()),
                   [&](std::int64_t v) { backward_gaussian(std::size_t(v), pairs, out); });
  }

  const ProjectedView<S>& view() const { return view_; }
  const TileLists& lists() const { return lists_; }

 private:
  void gather_channels(const Exec& exec) {
    const int count = request_.count();
    const Vec3<double> centre = camera_.centre();
    channel_.resize(view_.id.size() * std::size_t(count));
    for_each_index(exec, std::int64_t(view_.id.size()), [&](std::int64_t v) {
      S* row = channel_.data() + v * count;
      const std::int64_t i = view_.id[std::size_t(v)];
      if (request_.colour) {
        const Vec3<S> rgb = sh_colour(cloud_.sh_degree, narrowed<S>(offset_from(centre, cloud_.position + i * 3)),
                                      cloud_.sh_dc + i * 3, cloud_.sh_rest + i * cloud_.rest_stride * 3);
        *row++ = rgb.x, *row++ = rgb.y, *row++ = rgb.z;
      }
      if (request_.label.n > 0)
        for (int k = 0; k < request_.label.c; ++k) *row++ = request_.label.row(i)[k];
      if (request_.depth) *row = view_.depth[std::size_t(v)];
    });
  }

  TileWork<S> work(std::int64_t tile) const { return tile_work(view_, lists_, tile, camera_, options_.compat); }
  ChannelValues<S> channels() const { return {channel_.data(), request_.count()}; }
  static TileScratch<S>& thread_scratch() {
    static thread_local TileScratch<S> scratch;
    return scratch;
  }

  void clear(const Exec& exec, const CloudGradientView<S>& out) const {
    const int labels = request_.label.n > 0 ? request_.label.c : 0;
    for_each_index(exec, cloud_.size, [&](std::int64_t i) {
      const auto zero = [i](S* column, int width) {
        if (column) std::fill_n(column + i * width, width, S(0));
      };
      zero(out.position, 3), zero(out.rotation, 4), zero(out.log_scale, 3), zero(out.logit_opacity, 1);
      zero(out.sh_dc, 3), zero(out.sh_rest, cloud_.rest_stride * 3), zero(out.label, labels), zero(out.mean_px, 2);
      if (out.visible) out.visible[i] = 0;
    });
  }

  void backward_gaussian(std::size_t v, const Matrix<S>& pairs, const CloudGradientView<S>& out) const {
    using Wide = WideOf<S>;
    const std::int64_t begin = lists_.slot_begin[v], end = lists_.slot_begin[v + 1];
    if (begin == end) return;
    const std::int64_t i = view_.id[v];
    std::vector<Wide> sum(std::size_t(pairs.c), Wide(0));
    for (std::int64_t slot = begin; slot < end; ++slot)
      for (int c = 0; c < pairs.c; ++c) sum[std::size_t(c)] += Wide(pairs.row(slot)[c]);

    const Vec3<double> centre = camera_.centre();
    const ProjectionCamera<S> pc = projection_camera<S>(camera_, options_);
    const Vec3<Wide> wide_offset = offset_from(centre, cloud_.position + i * 3);
    const Vec3<S> offset = narrowed<S>(wide_offset), t = narrowed<S>(mat3_cast<Wide>(camera_.rotation) * wide_offset);
    ProjectionContext<S> ctx;
    const ProjectedGaussian<S> p = project_gaussian(pc, t, cloud_.rotation + i * 4, cloud_.log_scale + i * 3,
                                                    cloud_.logit_opacity[i], options_.antialiased, ctx);
    GaussianGradient<S> g = project_gaussian_backward(
        pc, t, p, ctx, options_.antialiased,
        ProjectedGradient<S>{S(sum[0]), S(sum[1]), S(sum[2]), S(sum[3]), S(sum[4]), S(sum[5])});
    int channel = kPairGeometry;
    Vec3<S> grad_offset{S(0), S(0), S(0)};
    if (request_.colour) {
      const Vec3<S> grad_rgb{S(sum[6]), S(sum[7]), S(sum[8])};
      channel += 3;
      const S* rest = cloud_.sh_rest + i * cloud_.rest_stride * 3;
      const Vec3<S> rgb = sh_colour(cloud_.sh_degree, offset, cloud_.sh_dc + i * 3, rest);
      S dc[3], rest_grad[45];
      grad_offset = sh_colour_backward(cloud_.sh_degree, offset, rest, rgb, grad_rgb, dc, rest_grad);
      if (out.sh_dc) std::copy_n(dc, 3, out.sh_dc + i * 3);
      if (out.sh_rest) std::copy_n(rest_grad, sh_rest_count(cloud_.sh_degree) * 3, out.sh_rest + i * cloud_.rest_stride * 3);
    }
    if (request_.label.n > 0)
      for (int k = 0; k < request_.label.c; ++k, ++channel)
        if (out.label) out.label[i * request_.label.c + k] = S(sum[std::size_t(channel)]);
    if (request_.depth) g.t.z += S(sum[std::size_t(channel)]);

    if (out.position) {
      const Vec3<S> world = transpose(pc.rotation) * g.t + grad_offset;
      S* o = out.position + i * 3;
      o[0] = world.x, o[1] = world.y, o[2] = world.z;
    }
    if (out.rotation) {
      S* o = out.rotation + i * 4;
      o[0] = g.rotation.x, o[1] = g.rotation.y, o[2] = g.rotation.z, o[3] = g.rotation.w;
    }
    if (out.log_scale) {
      S* o = out.log_scale + i * 3;
      o[0] = g.log_scale.x, o[1] = g.log_scale.y, o[2] = g.log_scale.z;
    }
    if (out.logit_opacity) out.logit_opacity[i] = g.logit_opacity;
    if (out.mean_px) out.mean_px[i * 2] = S(sum[0]), out.mean_px[i * 2 + 1] = S(sum[1]);
    if (out.visible) out.visible[i] = 1;
  }

  TileKernels<S> kernels_;
  SplatOptions options_;
  CloudView<S> cloud_;
  Camera camera_;
  ChannelRequest<S> request_;
  ProjectedView<S> view_;
  TileLists lists_;
  std::vector<S> background_, channel_;  // [C], [V, C]
};

}  // namespace ngs
