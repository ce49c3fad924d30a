#include <algorithm>

#include "ngs/core/check.h"
#include "ngs/io/files/atomic_file.h"
#include "ngs/io/ply/ply.h"

namespace ngs::io {
namespace {

constexpr std::size_t kBufferBytes = std::size_t(1) << 20;

}  // namespace

PlyWriter::PlyWriter(const std::string& path, const PlyElement& element, const std::vector<std::string>& comments)
    : file_(std::make_unique<AtomicFile>(path)), rows_left_(element.count) {
  std::string header =
      "ply\nformat binary_little_endian 1.0\nelement " + element.name + " " + std::to_string(element.count) + "\n";
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
