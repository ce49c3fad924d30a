#pragma once
// Scalar types, elements and tables of a PLY file (io/ply/ply.h).
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace ngs::io {

enum class PlyFormat : std::uint8_t { kAscii, kBinaryLittle, kBinaryBig };
enum class PlyType : std::uint8_t { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };

constexpr std::size_t ply_type_bytes(PlyType type) {
  constexpr std::size_t kBytes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return kBytes[std::size_t(type)];
}
std::string_view ply_type_name(PlyType type);               // "char" ... "double"
std::optional<PlyType> ply_type_of(std::string_view name);  // accepts both spellings, "float" and "float32"

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::kFloat32;
  bool is_list = false;
  PlyType count_type = PlyType::kUint8;  // lists only
};

struct PlyElement {
  std::string name;
  std::int64_t count = 0;
  std::vector<PlyProperty> properties;
  std::size_t begin = 0, end = 0;  // bytes of the file
};

/// One column of a PlyTable. Values convert to double exactly; floats keep their bits (NaN payloads included).
struct PlyColumn {
  const std::uint8_t* first = nullptr;  // null: no rows or no such property
  std::size_t stride = 0;               // bytes; 0: no such property
  PlyType type = PlyType::kFloat32;

  explicit operator bool() const { return stride > 0; }
  double value(std::int64_t row) const;
  float value_float(std::int64_t row) const;
};

/// The scalar properties of one element (lists are left out); rows packed without padding, little-endian.
struct PlyTable {
  std::vector<PlyProperty> properties;
  std::vector<std::size_t> offset;  // [properties] byte offset in a row
  std::size_t row_bytes = 0;
  std::int64_t rows = 0;
  const std::uint8_t* borrowed = nullptr;  // into the file, if its rows have this layout
  std::vector<std::uint8_t> owned;         // else the converted rows

  const std::uint8_t* row(std::int64_t i) const {
    return (owned.empty() ? borrowed : owned.data()) + std::size_t(i) * row_bytes;
  }
  int find(std::string_view name) const;  // -1: none
  PlyColumn column(std::string_view name) const;
  void set_properties(std::vector<PlyProperty> scalar_properties);  // and offset, row_bytes
};

/// Stores `value` as `type` at `to`; for integer types it is rounded and clamped, NaN becomes 0.
void ply_store(PlyType type, double value, std::uint8_t* to);
inline void ply_store_float(float value, std::uint8_t* to) { std::memcpy(to, &value, sizeof value); }

inline float PlyColumn::value_float(std::int64_t row) const {
  if (type != PlyType::kFloat32) return float(value(row));
  float v;
  std::memcpy(&v, first + std::size_t(row) * stride, sizeof v);
  return v;
}

}  // namespace ngs::io
