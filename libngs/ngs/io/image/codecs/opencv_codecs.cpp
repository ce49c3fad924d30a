// The plug-in behind image_codecs.h.
#include <climits>
#include <cstring>
#include <opencv2/core.hpp>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "ngs/io/image/image_codecs.h"

namespace ngs::io {
namespace {

Picture decode(Bytes bytes) {
  // OpenCV must not print: its messages would repeat the caller's error.
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  if (bytes.empty() || bytes.size() > std::size_t(INT_MAX)) return {};
  cv::Mat image;
  try {
    image = cv::imdecode(cv::Mat(1, int(bytes.size()), CV_8U, const_cast<std::uint8_t*>(bytes.data())),
                         cv::IMREAD_UNCHANGED);
  } catch (const cv::Exception&) {
    return {};
  }
  if (image.empty()) return {};
  const int bits = image.depth() == CV_8U ? 8 : image.depth() == CV_16U ? 16 : 0;
  if (bits == 0) return {image.cols, image.rows, image.channels(), bits, {}};  // not every sample type can be converted
  if (image.channels() == 3) cv::cvtColor(image, image, cv::COLOR_BGR2RGB);
  if (image.channels() == 4) cv::cvtColor(image, image, cv::COLOR_BGRA2RGBA);
  Picture picture{image.cols, image.rows, image.channels(), bits, {}};
  const std::size_t row_bytes = std::size_t(image.cols) * image.elemSize();
  picture.samples.resize(row_bytes * std::size_t(image.rows));
  for (int y = 0; y < image.rows; ++y)
    std::memcpy(picture.samples.data() + std::size_t(y) * row_bytes, image.ptr(y), row_bytes);
  return picture;
}

std::vector<std::uint8_t> encode(const PictureView& picture, const char* extension, const std::vector<int>& settings) {
  const int depth = picture.bits == 8 ? CV_8U : CV_16U;
  const cv::Mat image(picture.height_px, picture.width_px, CV_MAKETYPE(depth, picture.channels),
                      const_cast<void*>(picture.samples));
  cv::Mat ordered;  // a copy if the pixels change: the caller's stay untouched
  if (picture.channels == 1) ordered = image;
  if (picture.channels == 3) cv::cvtColor(image, ordered, cv::COLOR_RGB2BGR);
  if (picture.channels == 4) cv::cvtColor(image, ordered, cv::COLOR_RGBA2BGRA);
  std::vector<std::uint8_t> bytes;
  if (!cv::imencode(extension, ordered, bytes, settings)) bytes.clear();
  return bytes;
}

std::vector<std::uint8_t> encode_png(const PictureView& picture) {
  // Both parameters are set, because OpenCV's defaults differ between versions.
  return encode(picture, ".png",
                {cv::IMWRITE_PNG_COMPRESSION, 6, cv::IMWRITE_PNG_STRATEGY, cv::IMWRITE_PNG_STRATEGY_DEFAULT});
}

std::vector<std::uint8_t> encode_jpeg(const PictureView& picture, int quality) {
  return encode(picture, ".jpg", {cv::IMWRITE_JPEG_QUALITY, quality, cv::IMWRITE_JPEG_OPTIMIZE, 1});
}

}  // namespace
}  // namespace ngs::io

extern "C" const ngs::io::ImageCodecs ngs_image_codecs;
const ngs::io::ImageCodecs ngs_image_codecs{ngs::io::decode, ngs::io::encode_png, ngs::io::encode_jpeg};
