#include "ngs/ops/losses/photometric_impl.h"

namespace ngs {

template class PhotometricPass<float, double>;
template class PhotometricPass<double, double>;

PhotometricLoss photometric_loss(const Exec& exec, const PhotometricOptions& options, const ImageF& rendered,
                                 const ImageF& target) {
  const auto value = PhotometricPass<float>().evaluate(exec, options, {rendered, target}, nullptr);
  return {value.total, value.l1, value.ssim};
}

}  // namespace ngs
