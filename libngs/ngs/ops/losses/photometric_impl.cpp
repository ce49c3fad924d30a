#include "ngs/ops/losses/photometric_impl.h"

namespace ngs {

template class PhotometricPass<float, double>;
template class PhotometricPass<double, double>;

}  // namespace ngs
