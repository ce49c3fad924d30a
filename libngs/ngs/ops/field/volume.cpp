#include "ngs/ops/field/volume.h"

#include "ngs/backend/for_each.h"
#include "ngs/core/check.h"
#include "ngs/ops/device/device_ops.h"
#include "ngs/ops/field/volume_kernels.h"

namespace ngs {
namespace {

VolumeRays<float> rays_of(const VolumeInputs& in) {
  return {in.rays, in.samples, in.density, in.rgb, in.spacing, in.background};
}

}  // namespace

void volume_forward(const Exec& exec, const VolumeInputs& in, VolumeOutput& out) {
  const auto rays = std::size_t(in.rays), samples = std::size_t(in.samples);
  out.colour.resize(rays * 3);
  out.alpha.resize(rays);
  out.optical_depth.resize(rays);
  out.weight.resize(rays * samples);
  out.transmittance_after.resize(rays * samples);
  if (exec.device_ops) return exec.device_ops->field.volume_forward(in, out);
  for_each_index(exec, in.rays,
                 VolumeForward<float>{rays_of(in), out.colour.data(), out.alpha.data(), out.optical_depth.data(),
                                      out.weight.data(), out.transmittance_after.data()});
}

void volume_backward(const Exec& exec, const VolumeInputs& in, const VolumeOutput& forward,
                     const VolumeOutputGradients& grad, VolumeGradients& out) {
  const auto rays = std::size_t(in.rays), samples = std::size_t(in.samples);
  NGS_CHECK(grad.colour.size() == rays * 3 && grad.alpha.size() == rays, "one gradient per output");
  NGS_CHECK(grad.optical_depth.empty() || grad.optical_depth.size() == rays, "one gradient per output, or none");
  out.density.resize(rays * samples);
  out.rgb.resize(rays * samples * 3);
  if (exec.device_ops) return exec.device_ops->field.volume_backward(in, forward, grad, out);
  for_each_index(
      exec, in.rays,
      VolumeBackward<float>{rays_of(in), forward.weight.data(), forward.transmittance_after.data(), grad.colour.data(),
                            grad.alpha.data(), grad.optical_depth.empty() ? nullptr : grad.optical_depth.data(),
                            out.density.data(), out.rgb.data()});
}

}  // namespace ngs
