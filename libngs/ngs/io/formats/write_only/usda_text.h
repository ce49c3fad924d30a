#pragma once
// OpenUSD text.
#include <array>
#include <charconv>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ngs/core/version.h"
#include "ngs/io/formats/splat_table.h"

namespace ngs::io {

/// Floats are written in the fewest digits that read back as the same float.
class UsdaText {
 public:
  void add(std::string_view text) { bytes_.insert(bytes_.end(), text.begin(), text.end()); }
  /// In metres, y up.
  void add_header(std::string_view default_prim) {
    add("#usda 1.0\n(\n    defaultPrim = \"");
    add(default_prim);
    add("\"\n    doc = \"ngs ");
    add(kVersion);
    add("\"\n    metersPerUnit = 1\n    upAxis = \"Y\"\n)\n\n");
  }
  void add(float x) {
    char digits[24];
    add({digits, std::size_t(std::to_chars(digits, digits + sizeof digits, x).ptr - digits)});
  }
  void add(Vec3<float> v) { add(std::span<const float>(std::array{v.x, v.y, v.z})); }
  void add(std::uint32_t number) { add(std::to_string(number)); }
  /// One number, or (x, y, ...).
  void add(std::span<const float> values) {
    if (values.size() == 1) return add(values[0]);
    for (std::size_t k = 0; k < values.size(); ++k) {
      add(k == 0 ? "(" : ", ");
      add(values[k]);
    }
    add(")");
  }
  std::vector<std::uint8_t> take() && { return std::move(bytes_); }

 private:
  std::vector<std::uint8_t> bytes_;
};

/// The prim of encode_usda(), without the header of the file.
void add_usda_splat(const SplatSelection& model, UsdaText& text);
/// `values`, separated by commas, in brackets.
template <class T>
void add_usda_list(const std::vector<T>& values, UsdaText& text) {
  text.add("[");
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (k > 0) text.add(", ");
    text.add(values[k]);
  }
  text.add("]");
}

}  // namespace ngs::io
