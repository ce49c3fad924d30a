#include <algorithm>
#include <cstring>

#include "ngs/core/error.h"
#include "ngs/io/formats/quantise.h"
#include "ngs/io/formats/splat_codecs.h"
#include "ngs/math/elementary.h"

namespace ngs::io {
namespace {

constexpr std::size_t kHeaderBytes = 4096, kSectionBytes = 1024;

/// Bytes per Gaussian of each attribute, by compression level; the colour has always 4.
struct Layout {
  std::size_t position, scale, rotation, harmonic;
  std::size_t scale_at() const { return position; }
  std::size_t rotation_at() const { return position + scale; }
  std::size_t colour_at() const { return position + scale + rotation; }
  std::size_t harmonics_at() const { return colour_at() + 4; }
};
constexpr Layout kLayouts[3] = {{12, 12, 16, 4}, {6, 6, 8, 2}, {6, 6, 8, 1}};

struct Section {
  std::size_t rows, capacity_rows;            // used, allocated in the file
  std::size_t bucket_rows, buckets;           // rows of a full bucket, number of buckets
  std::size_t bucket_bytes;                   // per bucket centre
  std::size_t full_buckets, partial_buckets;  // partial buckets come last, with explicit sizes
  double block_size, range;                   // block size in world units, and the integer that encodes half of it
  std::uint32_t degree;
  std::size_t row_bytes;
  std::size_t sizes_at, centres_at, rows_at, end;  // byte offsets in the file
};

class KsplatReader {
 public:
  KsplatReader(const std::string& name, Bytes bytes) : name_(name), bytes_(bytes) {
    if (bytes.size() < kHeaderBytes) bad(std::to_string(bytes.size()) + " bytes, expected a header of 4096 (.ksplat)");
    if (bytes[0] != 0 || bytes[1] < 1)
      bad("version " + std::to_string(bytes[0]) + "." + std::to_string(bytes[1]) +
          " of .ksplat, expected 0.1 or later");
    count_ = at<std::uint32_t>(16);
    const auto compression = at<std::uint16_t>(20);
    if (compression > 2) bad("compression " + std::to_string(compression) + ", expected 0, 1 or 2");
    compression_ = compression;
    layout_ = kLayouts[compression];
    low_ = at<float>(36);
    high_ = at<float>(40);
    if (low_ == 0) low_ = -1.5f;
    if (high_ == 0) high_ = 1.5f;
    read_sections();
  }

  DecodedSplat decode() const {
    int degree = 0;
    for (const Section& section : sections_) degree = std::max(degree, int(section.degree));
    DecodedSplat decoded;
    decoded.rows = splat_table(std::int64_t(count_), degree);
    std::int64_t to = 0;
    for (const Section& section : sections_) {
      std::size_t bucket = 0, left = section.buckets > 0 ? bucket_size(section, 0) : 0;
      for (std::size_t i = 0; i < section.rows; ++i, ++to) {
        while (compression_ > 0 && left == 0) {
          if (++bucket >= section.buckets) bad("a section's buckets have less capacity than it has Gaussians");
          left = bucket_size(section, bucket);
        }
        store_row(decoded.rows, to, row(section, i, bucket));
        if (compression_ > 0) --left;
      }
    }
    decoded.notes.push_back(".ksplat: attributes are quantised");
    return decoded;
  }

 private:
  [[noreturn]] void bad(const std::string& message) const {
    throw Error(ErrorCode::kBadInput, name_ + ": " + message, "copy or export it again");
  }

  template <class T>
  T at(std::size_t byte) const {
    if (byte > bytes_.size() || sizeof(T) > bytes_.size() - byte)
      bad("ends at byte " + std::to_string(bytes_.size()) + ", expected a complete file");
    T value;
    std::memcpy(&value, bytes_.data() + byte, sizeof value);
    return value;
  }

  void read_sections() {
    const std::size_t most = at<std::uint32_t>(4);
    if (most > (bytes_.size() - kHeaderBytes) / kSectionBytes)
      bad(std::to_string(most) + " sections, expected at most as many as the file can hold");
    std::size_t end = kHeaderBytes + most * kSectionBytes, rows = 0;
    for (std::size_t s = 0; s < most; ++s) {
      const Section section = section_at(kHeaderBytes + s * kSectionBytes, end);
      end = section.end;
      rows += section.rows;
      if (section.rows > 0) sections_.push_back(section);
    }
    if (rows != count_) bad(std::to_string(rows) + " Gaussians in its sections, expected " + std::to_string(count_));
  }

  Section section_at(std::size_t header, std::size_t begin) const {
    Section s{};
    s.rows = at<std::uint32_t>(header);
    s.capacity_rows = at<std::uint32_t>(header + 4);
    s.bucket_rows = at<std::uint32_t>(header + 8);
    s.buckets = at<std::uint32_t>(header + 12);
    s.block_size = double(at<float>(header + 16));
    s.bucket_bytes = at<std::uint16_t>(header + 20);
    const auto range = at<std::uint32_t>(header + 24);
    s.range = range != 0 ? double(range) : 32767;
    s.full_buckets = at<std::uint32_t>(header + 32);
    s.partial_buckets = at<std::uint32_t>(header + 36);
    s.degree = at<std::uint16_t>(header + 40);
    if (s.degree > 3) bad("SH degree " + std::to_string(s.degree) + ", expected 0 to 3");
    s.row_bytes = layout_.harmonics_at() + layout_.harmonic * 3 * std::size_t(sh_rest_count(int(s.degree)));
    s.sizes_at = begin;
    s.centres_at = s.sizes_at + s.partial_buckets * 4;
    s.rows_at = s.centres_at + s.buckets * s.bucket_bytes;
    s.end = s.rows_at + s.capacity_rows * s.row_bytes;
    if (s.end > bytes_.size())
      bad("a section ends at byte " + std::to_string(s.end) + " of " + std::to_string(bytes_.size()) +
          ", expected a complete file");
    if (s.rows > s.capacity_rows)
      bad(std::to_string(s.rows) + " Gaussians in a section, expected at most " + std::to_string(s.capacity_rows));
    const bool has_centres =
        compression_ == 0 || s.rows == 0 || (s.bucket_bytes >= 12 && s.full_buckets + s.partial_buckets <= s.buckets);
    if (!has_centres) bad("a section without the centres of its buckets, expected 12 bytes each");
    return s;
  }

  /// Gaussians in a bucket: full buckets come first, then partial ones with explicit sizes.
  std::size_t bucket_size(const Section& s, std::size_t bucket) const {
    if (compression_ == 0) return s.rows;
    if (bucket < s.full_buckets) return s.bucket_rows;
    if (bucket - s.full_buckets < s.partial_buckets)
      return at<std::uint32_t>(s.sizes_at + (bucket - s.full_buckets) * 4);
    return 0;
  }

  /// Element k of an attribute stored as floats, or as half floats.
  float number(std::size_t byte, std::size_t k) const {
    return compression_ == 0 ? at<float>(byte + k * 4) : half_to_float(at<std::uint16_t>(byte + k * 2));
  }

  SplatRow row(const Section& s, std::size_t i, std::size_t bucket) const {
    const std::size_t from = s.rows_at + i * s.row_bytes;
    SplatRow row;
    for (std::size_t a = 0; a < 3; ++a) {
      row.position[a] = compression_ == 0 ? number(from, a) : position(s, from, bucket, a);
      row.log_scale[a] = log_of(number(from + layout_.scale_at(), a));
      row.sh_dc[a] = float(dc_of_colour(at<std::uint8_t>(from + layout_.colour_at() + a) / 255.0));
    }
    for (std::size_t k = 0; k < 4; ++k) row.rotation[k] = number(from + layout_.rotation_at(), k);
    row.logit_opacity = logit_of_alpha_byte(at<std::uint8_t>(from + layout_.colour_at() + 3));
    for (int degree = 1; degree <= int(s.degree); ++degree) read_band(from + layout_.harmonics_at(), degree, row);
    return row;
  }

  float position(const Section& s, std::size_t from, std::size_t bucket, std::size_t axis) const {
    const double step = s.block_size / 2 / s.range;
    const float centre = at<float>(s.centres_at + bucket * s.bucket_bytes + axis * 4);
    return float((double(at<std::uint16_t>(from + axis * 2)) - s.range) * step + double(centre));
  }

  /// The SH coefficients of one degree: all of red, then green, then blue.
  void read_band(std::size_t from, int degree, SplatRow& row) const {
    const std::size_t before = std::size_t(sh_rest_count(degree - 1)), n = std::size_t(2 * degree + 1);
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t k = 0; k < n; ++k) row.sh_rest[(before + k) * 3 + c] = harmonic(from, before * 3 + c * n + k);
  }

  float harmonic(std::size_t from, std::size_t k) const {
    if (compression_ < 2) return number(from, k);
    return float(double(low_) + at<std::uint8_t>(from + k) / 255.0 * (double(high_) - double(low_)));
  }

  const std::string& name_;
  Bytes bytes_;
  std::size_t count_ = 0;
  int compression_ = 0;
  Layout layout_{};
  float low_ = 0, high_ = 0;
  std::vector<Section> sections_;
};

}  // namespace

DecodedSplat decode_ksplat(const std::string& name, Bytes bytes) { return KsplatReader(name, bytes).decode(); }

}  // namespace ngs::io
