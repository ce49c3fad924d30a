#pragma once
// Forward and backward of one whole view, templated on the lane type. Internal to ops: splat.cpp instantiates it
// with PackF; tests with double and Dual<double>.
#include "ngs/ops/splat_tiles.h"

namespace ngs {

/// Where one channel of an image lives: pixel i at data[i · stride]. Null data: not wanted / zero.
template <class T>
struct Plane {
  T* data = nullptr;
  int stride = 1;
};

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

template <class L>
class SplatEngine {
 public:
  using S = typename LaneTraits<L>::Scalar;
  static constexpr int kLanes = LaneTraits<L>::kLanes;

  SplatEngine(const SplatOptions& options, const CloudView<S>& cloud, const Camera& camera,
              const ChannelRequest<S>& request)
      : options_(options), cloud_(cloud), camera_(camera), request_(request) {}

  /// Writes channel c to out[c] and 1 - T_final to out[count()].
  void forward(const Exec& exec, const std::vector<Plane<S>>& out) {
    view_ = project_view(exec, cloud_, camera_, options_);
    lists_ = bin_tiles(exec, view_, camera_.width_px, camera_.height_px);
    gather_channels(exec);
    for_each_task(exec, lists_.tiles(), [&](std::int64_t tile) { forward_tile(tile, out); });
  }

  /// grad[c]: ∂L/∂(out[c] of forward), grad[count()]: ∂L/∂alpha. moves[c]: see composite_tile_backward.
  void backward(const Exec& exec, const std::vector<Plane<const S>>& grad, const std::vector<std::uint8_t>& moves,
                const CloudGradientView<S>& out) {
    const int columns = kPairGeometry + request_.count();
    std::vector<S> pair_grad(std::size_t(lists_.pairs()) * std::size_t(columns), S(0));
    const Matrix<S> pairs{pair_grad.data(), lists_.pairs(), columns};
    for_each_task(exec, lists_.tiles(), [&](std::int64_t tile) { backward_tile(tile, grad, moves, pairs); });
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

  S background(int channel) const {
    if (!request_.colour || channel > 2) return S(0);
    return channel == 0 ? request_.background.x : channel == 1 ? request_.background.y : request_.background.z;
  }

  template <class F>
  void for_each_pixel(const TileFrame& frame, F&& f) const {  // f(pack, lane, pixel index)
    for (int y = 0; y < frame.rows(); ++y)
      for (int x = 0; x < frame.columns(); ++x)
        f(y * kPacksPerRow<L> + x / kLanes, x % kLanes, std::size_t(frame.y_px + y) * std::size_t(frame.width_px) + std::size_t(frame.x_px + x));
  }

  void forward_tile(std::int64_t tile, const std::vector<Plane<S>>& out) const {
    const TileFrame frame = tile_frame(lists_, tile, camera_.width_px, camera_.height_px);
    const int count = request_.count();
    L transmittance[kPacksPerTile<L>];
    std::vector<L> sum(std::size_t(count) * kPacksPerTile<L>, L(S(0)));
    ChannelSink<L> sink{lists_, {channel_.data(), std::int64_t(view_.id.size()), count}, sum.data()};
    composite_tile<L>(frame, lists_, tile, view_.record, options_.compat, transmittance, sink);
    S lanes[kLanes];
    for (int c = 0; c <= count; ++c) {
      const Plane<S>& plane = out[std::size_t(c)];
      if (plane.data == nullptr) continue;
      for_each_pixel(frame, [&](int pack, int lane, std::size_t pixel) {
        if (lane == 0) {
          const L value = c == count ? L(S(1)) - transmittance[pack]
                                     : fma_lanes(transmittance[pack], L(background(c)), sum[std::size_t(c) * kPacksPerTile<L> + std::size_t(pack)]);
          store_lanes(lanes, value);
        }
        plane.data[pixel * std::size_t(plane.stride)] = lanes[lane];
      });
    }
  }

  void backward_tile(std::int64_t tile, const std::vector<Plane<const S>>& grad, const std::vector<std::uint8_t>& moves,
                     const Matrix<S>& pairs) const {
    if (lists_.tile_begin[std::size_t(tile)] == lists_.tile_begin[std::size_t(tile) + 1]) return;
    const TileFrame frame = tile_frame(lists_, tile, camera_.width_px, camera_.height_px);
    const int count = request_.count();
    std::vector<L> grad_lanes(std::size_t(count + 1) * kPacksPerTile<L>, L(S(0)));
    bool all_zero = true;
    for (int c = 0; c <= count; ++c) {
      const Plane<const S>& plane = grad[std::size_t(c)];
      if (plane.data == nullptr) continue;
      S lanes[kPacksPerTile<L> * kLanes] = {};
      for_each_pixel(frame, [&](int pack, int lane, std::size_t pixel) {
        const S g = plane.data[pixel * std::size_t(plane.stride)];
        lanes[pack * kLanes + lane] = g;
        all_zero &= g == S(0);
      });
      for (int pack = 0; pack < kPacksPerTile<L>; ++pack)
        load_lanes(lanes + pack * kLanes, grad_lanes[std::size_t(c) * kPacksPerTile<L> + std::size_t(pack)]);
    }
    if (all_zero) return;  // a loss that does not look at this tile costs nothing here
    static thread_local TapeSink<L> tape;
    tape.clear();
    L transmittance[kPacksPerTile<L>];
    composite_tile<L>(frame, lists_, tile, view_.record, options_.compat, transmittance, tape);
    std::vector<S> behind(std::size_t(count), S(0));
    for (int c = 0; c < count; ++c) behind[std::size_t(c)] = background(c);
    composite_tile_backward<L>(frame, lists_, view_.record, {channel_.data(), std::int64_t(view_.id.size()), count}, tape,
                               grad_lanes.data(), moves.data(), behind.data(), pairs);
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

  SplatOptions options_;
  CloudView<S> cloud_;
  Camera camera_;
  ChannelRequest<S> request_;
  ProjectedView<S> view_;
  TileLists lists_;
  std::vector<S> channel_;  // [V, C]
};

}  // namespace ngs
