#include <algorithm>
#include <cmath>
#include <limits>

#include "ngs/core/check.h"
#include "ngs/io/files/atomic_file.h"
#include "ngs/io/ply/ply.h"

namespace ngs::io {
namespace {

constexpr std::size_t kBufferBytes = std::size_t(1) << 20;

template <class T>
void store_integer(double value, std::uint8_t* to) {
  constexpr double kLow = double(std::numeric_limits<T>::min()),
                   kHigh = double(std::numeric_limits<T>::max());
  const T v = std::isnan(value) ? T(0) : T(std::clamp(std::nearbyint(value), kLow, kHigh));
  std::memcpy(to, &v, sizeof v);
}

}  // namespace

void ply_store(PlyType type, double value, std::uint8_t* to) {
  switch (type) {
    case PlyType::kInt8:
      return store_integer<std::int8_t>(value, to);
    case PlyType::kUint8:
      return store_integer<std::uint8_t>(value, to);
    case PlyType::kInt16:
      return store_integer<std::int16_t>(value, to);
    case PlyType::kUint16:
      return store_integer<std::uint16_t>(value, to);
    case PlyType::kInt32:
      return store_integer<std::int32_t>(value, to);
    case PlyType::kUint32:
      return store_integer<std::uint32_t>(value, to);
    case PlyType::kFloat32:
      return ply_store_float(float(value), to);
    case PlyType::kFloat64:
      std::memcpy(to, &value, sizeof value);
      return;
  }
}

PlyWriter::PlyWriter(const std::string& path, const PlyElement& element,
                     const std::vector<std::string>& comments)
    : file_(std::make_unique<AtomicFile>(path)), rows_left_(element.count) {
  std::string header = "ply\nformat binary_little_endian 1.0\nelement " + element.name + " " +
                       std::to_string(element.count) + "\n";
  for (const PlyProperty& p : element.properties) {
    header += "property " + std::string(ply_type_name(p.type)) + " " + p.name + "\n";
    row_bytes_ += ply_type_bytes(p.type);
  }
  for (std::string comment : comments) {
    std::replace_if(
        comment.begin(), comment.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
    header += "comment " + comment + "\n";
  }
  header += "end_header\n";
  file_->write(header);
  buffer_.resize(std::max(kBufferBytes / std::max(row_bytes_, std::size_t(1)), std::size_t(1)) * row_bytes_);
}

PlyWriter::~PlyWriter() = default;

std::uint8_t* PlyWriter::row() {
  NGS_CHECK(rows_left_ > 0, "more rows than the header says");
  --rows_left_;
  if (used_ == buffer_.size()) flush();
  std::uint8_t* to = buffer_.data() + used_;
  used_ += row_bytes_;
  return to;
}

void PlyWriter::flush() {
  file_->write(buffer_.data(), used_);
  used_ = 0;
}

void PlyWriter::commit() {
  NGS_CHECK(rows_left_ == 0, std::to_string(rows_left_) + " rows fewer than the header says");
  flush();
  file_->commit();
}

}  // namespace ngs::io
