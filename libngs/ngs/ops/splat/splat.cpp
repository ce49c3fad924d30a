#include "ngs/ops/splat/splat.h"

#include "ngs/core/check.h"
#include "ngs/ops/device/device_ops.h"
#include "ngs/ops/splat/cloud_view.h"
#include "ngs/ops/splat/prepared/prepared_cloud.h"
#include "ngs/ops/splat/tile_isa.h"
#include "ngs/ops/splat/view_planes.h"

namespace ngs {
namespace {

std::unique_ptr<DeviceSplat> device_view(const Exec& exec, const CloudView<float>& cloud, const Camera& relative,
                                         const SplatOptions& options, const ChannelPlan<float>& plan) {
  return exec.device_ops->splat.view(view_projector<float>(relative, options), on_host(cloud, options), plan);
}

}  // namespace

struct SplatPass::State {
  SplatOptions options;
  ResidentResults* images;  // null: on the host
  ChannelPlan<float> plan;
  std::unique_ptr<SplatEngine<float>> engine;
  std::unique_ptr<DeviceSplat> on_device;  // instead of the engine
  RenderedView rendered;
  std::int64_t gaussians = 0;
  std::size_t rest_values = 0;  // of a Gaussian
};

SplatPass::SplatPass(SplatOptions options, ResidentResults* images) : state_(std::make_unique<State>()) {
  state_->options = std::move(options);
  state_->images = images;
}
SplatPass::~SplatPass() = default;
SplatPass::SplatPass(SplatPass&&) noexcept = default;
SplatPass& SplatPass::operator=(SplatPass&&) noexcept = default;

RenderedView& SplatPass::forward(const Exec& exec, const GaussianCloud& cloud, const Camera& camera,
                                 const RenderRequest& request) {
  State& s = *state_;
  s.plan = channel_plan(request);
  if (s.images)
    allocate(camera, s.plan, *s.images, s.rendered);
  else
    allocate(camera, s.plan, s.rendered);
  s.gaussians = cloud.size();
  s.rest_values = std::size_t(cloud.rest_count()) * 3;
  const CloudView<float> view = cloud_view(cloud, s.options.max_sh_degree, request.include);
  s.on_device.reset();
  if (exec.device_ops) {
    s.on_device = device_view(exec, view, relative_camera(camera, cloud), s.options, s.plan);
    s.on_device->forward(planes<float>(s.plan, s.rendered), true);
    return s.rendered;
  }
  s.engine = std::make_unique<SplatEngine<float>>(float_tile_kernels(exec.isa), s.options, view,
                                                  relative_camera(camera, cloud), s.plan);
  s.engine->cull({.tiles = request.tiles});
  s.engine->forward(exec, planes<float>(s.plan, s.rendered));
  return s.rendered;
}

void SplatPass::backward(const Exec& exec, const ViewGradients& gradients, CloudGradients& out,
                         const GradientRows& wanted) {
  const State& s = *state_;
  const auto all = std::size_t(s.gaussians);
  const bool some = !wanted.gradient_row.empty();
  NGS_CHECK(wanted.label_only.empty() || wanted.label_only.size() == all, "one flag per Gaussian");
  NGS_CHECK(!some || wanted.gradient_row.size() == all, "one row per Gaussian");
  const std::size_t n = some ? std::size_t(wanted.rows) : all;
  out.resize(n, wanted.sh_rest ? s.rest_values : 0, std::size_t(s.plan.labels()));
  std::vector<std::uint8_t> moves;
  if (s.plan.colour) moves.insert(moves.end(), 3, gradients.colour_moves_geometry);
  if (s.plan.label.n > 0) moves.insert(moves.end(), std::size_t(s.plan.label.c), gradients.label_moves_geometry);
  if (s.plan.depth) moves.push_back(gradients.depth_moves_geometry);
  const CloudGradientView<float> view{out.position.data(),
                                      out.rotation.data(),
                                      out.log_scale.data(),
                                      out.logit_opacity.data(),
                                      out.sh_dc.data(),
                                      wanted.sh_rest ? out.sh_rest.data() : nullptr,
                                      out.label.data(),
                                      out.mean_px.data(),
                                      out.visible.data(),
                                      wanted.label_only.empty() ? nullptr : wanted.label_only.data(),
                                      some ? wanted.gradient_row.data() : nullptr,
                                      wanted.rows};
  const std::vector<Plane<const float>> image = planes<const float>(s.plan, gradients);
  if (s.on_device)
    s.on_device->backward(image, moves, view);
  else
    s.engine->backward(exec, image, moves, view);
}

RenderedView render(const Exec& exec, const GaussianCloud& cloud, const Camera& camera, const SplatOptions& options,
                    const RenderRequest& request) {
  const ChannelPlan<float> channels = channel_plan(request);
  RenderedView view;
  allocate(camera, channels, view);
  const CloudView<float> on_view = cloud_view(cloud, options.max_sh_degree, request.include);
  if (exec.device_ops) {
    const std::lock_guard one_at_a_time(exec.device_ops->rendering);
    device_view(exec, on_view, relative_camera(camera, cloud), options, channels)
        ->forward(planes<float>(channels, view), false);
    return view;
  }
  SplatEngine<float> engine(float_tile_kernels(exec.isa), options, on_view, relative_camera(camera, cloud), channels);
  engine.cull({.tiles_touching = request.tiles_touching, .stop_after = request.stop_after, .tiles = request.tiles});
  engine.forward(exec, planes<float>(channels, view));
  return view;
}

}  // namespace ngs
