#include "ngs/io/formats/compression/refuse_web.h"
#include "ngs/io/image/image_file.h"

namespace ngs::io {
namespace {

ImageF resize(const ImageF& image, int width_px, int height_px) {
  if (image.width_px == width_px && image.height_px == height_px) return image;
  refuse_in_browser("picture", "a size that differs from that of its view");
}

}  // namespace

ImageF resize_area(const ImageF& image, int width_px, int height_px) { return resize(image, width_px, height_px); }
ImageF resize_nearest(const ImageF& image, int width_px, int height_px) { return resize(image, width_px, height_px); }

}  // namespace ngs::io
