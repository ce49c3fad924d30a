#include "ngs/io/image_file.h"

#include <climits>
#include <opencv2/core.hpp>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "ngs/core/check.h"
#include "ngs/core/error.h"
#include "ngs/io/atomic_file.h"
#include "ngs/io/image_header.h"
#include "ngs/io/regular_file.h"

namespace ngs::io {
namespace {

cv::Mat decode(Bytes bytes, const std::string& path) {
  // The library never prints: OpenCV's own messages repeat what the Error below says.
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  cv::Mat image;
  try {
    if (!bytes.empty() && bytes.size() <= std::size_t(INT_MAX))
      image = cv::imdecode(cv::Mat(1, int(bytes.size()), CV_8U, const_cast<std::uint8_t*>(bytes.data())),
                           cv::IMREAD_UNCHANGED);
  } catch (const cv::Exception&) {
    image.release();
  }
  if (image.empty())
    throw Error(ErrorCode::kBadInput,
                path + ": not a readable image, expected PNG, JPEG or another common format");
  if ((image.depth() != CV_8U && image.depth() != CV_16U) ||
      (image.channels() != 1 && image.channels() != 3 && image.channels() != 4))
    throw Error(ErrorCode::kBadInput,
                path + ": samples of an unsupported type, expected 8 or 16 bit, 1, 3 or 4 channels",
                "convert it, e.g. with: convert " + path + " -depth 8 out.png");
  if (image.channels() == 3) cv::cvtColor(image, image, cv::COLOR_BGR2RGB);
  if (image.channels() == 4) cv::cvtColor(image, image, cv::COLOR_BGRA2RGBA);
  return image;
}

/// visit(flat index of the sample, value)
template <class Visit>
void for_each_sample(const cv::Mat& image, const Visit& visit) {
  const int row_samples = image.cols * image.channels();
  for (int y = 0; y < image.rows; ++y) {
    const std::size_t start = std::size_t(y) * std::size_t(row_samples);
    for (int i = 0; i < row_samples; ++i)
      visit(start + std::size_t(i), image.depth() == CV_8U ? std::uint16_t(image.ptr<std::uint8_t>(y)[i])
                                                           : image.ptr<std::uint16_t>(y)[i]);
  }
}

template <class T>
void write_png_of(const std::string& path, const Image<T>& image, int depth) {
  NGS_CHECK(image.channels == 1 || image.channels == 3 || image.channels == 4,
            "PNG needs 1, 3 or 4 channels");
  cv::Mat mat(image.height_px, image.width_px, CV_MAKETYPE(depth, image.channels),
              const_cast<T*>(image.data.data()));
  cv::Mat ordered;  // never shares the caller's pixels
  if (image.channels == 1) ordered = mat;
  if (image.channels == 3) cv::cvtColor(mat, ordered, cv::COLOR_RGB2BGR);
  if (image.channels == 4) cv::cvtColor(mat, ordered, cv::COLOR_RGBA2BGRA);
  std::vector<unsigned char> bytes;
  // Both parameters are set, because OpenCV's defaults differ between versions.
  const std::vector<int> settings{cv::IMWRITE_PNG_COMPRESSION, 6, cv::IMWRITE_PNG_STRATEGY,
                                  cv::IMWRITE_PNG_STRATEGY_DEFAULT};
  if (!cv::imencode(".png", ordered, bytes, settings))
    throw Error(ErrorCode::kEnvironment, path + ": the PNG encoder failed, expected a compressed image");
  write_file(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

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

ImageF read_image_rgb(const std::string& path) {
  const MappedFile file = map_regular_file(path);
  parse_image_header(file.bytes(), path);
  const cv::Mat image = decode(file.bytes(), path);
  const std::size_t channels = std::size_t(image.channels());
  const float scale = image.depth() == CV_8U ? 1.f / 255.f : 1.f / 65535.f;
  ImageF out(image.cols, image.rows, 3);
  for_each_sample(image, [&](std::size_t i, std::uint16_t value) {
    const std::size_t pixel = i / channels, channel = i % channels;
    if (channel >= 3) return;
    const float v = float(value) * scale;
    if (channels == 1)
      out.data[pixel * 3] = out.data[pixel * 3 + 1] = out.data[pixel * 3 + 2] = v;
    else
      out.data[pixel * 3 + channel] = v;
  });
  return out;
}

RawMask read_mask_raw(const std::string& path) {
  const MappedFile file = map_regular_file(path);
  const auto header = parse_image_header(file.bytes(), path);
  const bool palette = header && header->palette;
  const std::vector<std::uint8_t> indices =
      palette ? palette_png_as_indices(file.bytes()) : std::vector<std::uint8_t>{};
  const cv::Mat image = decode(palette ? Bytes(indices) : file.bytes(), path);
  RawMask mask{image.cols,
               image.rows,
               image.channels(),
               image.depth() == CV_8U ? 8 : 16,
               header && header->format == ImageFormat::kJpeg,
               {}};
  mask.data.resize(image.total() * std::size_t(image.channels()));
  // Decoders stretch 1, 2 and 4 bit grey to 0..255; an index must come back as itself.
  const int stretch = palette && header->bits < 8 ? 255 / ((1 << header->bits) - 1) : 1;
  for_each_sample(image,
                  [&](std::size_t i, std::uint16_t value) { mask.data[i] = std::uint16_t(value / stretch); });
  return mask;
}

ImageSize read_image_size(const std::string& path) {
  const MappedFile file = map_regular_file(path);
  if (const auto header = parse_image_header(file.bytes(), path))
    return {header->width_px, header->height_px};
  const cv::Mat image = decode(file.bytes(), path);
  return {image.cols, image.rows};
}

std::string to_string(ImageSize size) {
  return std::to_string(size.width_px) + "x" + std::to_string(size.height_px);
}

void write_png(const std::string& path, const ImageU8& image) { write_png_of(path, image, CV_8U); }
void write_png16(const std::string& path, const ImageU16& image) { write_png_of(path, image, CV_16U); }

std::vector<std::uint8_t> encode_jpeg(const ImageU8& image, int quality) {
  NGS_CHECK(image.channels == 3 && !image.empty(), "JPEG needs an RGB image");
  const cv::Mat mat(image.height_px, image.width_px, CV_8UC3, const_cast<std::uint8_t*>(image.data.data()));
  cv::Mat ordered;
  cv::cvtColor(mat, ordered, cv::COLOR_RGB2BGR);
  std::vector<std::uint8_t> bytes;
  if (!cv::imencode(".jpg", ordered, bytes, {cv::IMWRITE_JPEG_QUALITY, quality, cv::IMWRITE_JPEG_OPTIMIZE, 1}))
    throw Error(ErrorCode::kEnvironment, "the JPEG encoder failed, expected a compressed image");
  return bytes;
}

ImageF resize_area(const ImageF& image, int width_px, int height_px) {
  return resize(image, width_px, height_px, cv::INTER_AREA);
}

ImageF resize_nearest(const ImageF& image, int width_px, int height_px) {
  return resize(image, width_px, height_px, cv::INTER_NEAREST_EXACT);
}

}  // namespace ngs::io
