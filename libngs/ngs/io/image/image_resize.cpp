#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "ngs/core/check.h"
#include "ngs/io/image/image_file.h"

namespace ngs::io {
namespace {

ImageF resize(const ImageF& image, int width_px, int height_px, int method) {
  NGS_CHECK(!image.empty() && width_px > 0 && height_px > 0, "resize needs a non-empty image and size");
  if (image.width_px == width_px && image.height_px == height_px) return image;
  ImageF out(width_px, height_px, image.channels);
  const cv::Mat from(image.height_px, image.width_px, CV_MAKETYPE(CV_32F, image.channels),
                     const_cast<float*>(image.data.data()));
  cv::Mat to(height_px, width_px, from.type(), out.data.data());
  cv::resize(from, to, to.size(), 0, 0, method);
  return out;
}

}  // namespace

ImageF resize_area(const ImageF& image, int width_px, int height_px) {
  return resize(image, width_px, height_px, cv::INTER_AREA);
}

ImageF resize_nearest(const ImageF& image, int width_px, int height_px) {
  return resize(image, width_px, height_px, cv::INTER_NEAREST_EXACT);
}

}  // namespace ngs::io
