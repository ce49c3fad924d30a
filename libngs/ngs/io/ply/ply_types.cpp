#include "ngs/io/ply/ply_types.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace ngs::io {
namespace {

static_assert(std::endian::native == std::endian::little, "PLY rows are used in place as little-endian");

struct TypeName {
  std::string_view name;
  PlyType type;
};
constexpr TypeName kTypeNames[] = {
    {"char", PlyType::kInt8},      {"uchar", PlyType::kUint8},    {"short", PlyType::kInt16},
    {"ushort", PlyType::kUint16},  {"int", PlyType::kInt32},      {"uint", PlyType::kUint32},
    {"float", PlyType::kFloat32},  {"double", PlyType::kFloat64}, {"int8", PlyType::kInt8},
    {"uint8", PlyType::kUint8},    {"int16", PlyType::kInt16},    {"uint16", PlyType::kUint16},
    {"int32", PlyType::kInt32},    {"uint32", PlyType::kUint32},  {"float32", PlyType::kFloat32},
    {"float64", PlyType::kFloat64}};

template <class T>
double load_as(const std::uint8_t* from) {
  T v;
  std::memcpy(&v, from, sizeof v);
  return double(v);
}

template <class T>
void store_integer(double value, std::uint8_t* to) {
  constexpr double kLow = double(std::numeric_limits<T>::min()), kHigh = double(std::numeric_limits<T>::max());
  const T v = std::isnan(value) ? T(0) : T(std::clamp(std::nearbyint(value), kLow, kHigh));
  std::memcpy(to, &v, sizeof v);
}

}  // namespace

std::string_view ply_type_name(PlyType type) { return kTypeNames[std::size_t(type)].name; }

std::optional<PlyType> ply_type_of(std::string_view name) {
  for (const TypeName& t : kTypeNames)
    if (t.name == name) return t.type;
  return std::nullopt;
}

int PlyTable::find(std::string_view name) const {
  for (std::size_t p = 0; p < properties.size(); ++p)
    if (properties[p].name == name) return int(p);
  return -1;
}

PlyColumn PlyTable::column(std::string_view name) const {
  const int p = find(name);
  if (p < 0) return {};
  return {rows > 0 ? row(0) + offset[std::size_t(p)] : nullptr, row_bytes, properties[std::size_t(p)].type};
}

void PlyTable::set_properties(std::vector<PlyProperty> scalar_properties) {
  properties = std::move(scalar_properties);
  offset.clear();
  row_bytes = 0;
  for (const PlyProperty& p : properties) {
    offset.push_back(row_bytes);
    row_bytes += ply_type_bytes(p.type);
  }
}

double PlyColumn::value(std::int64_t row) const {
  const std::uint8_t* from = first + std::size_t(row) * stride;
  switch (type) {
    case PlyType::kInt8: return load_as<std::int8_t>(from);
    case PlyType::kUint8: return load_as<std::uint8_t>(from);
    case PlyType::kInt16: return load_as<std::int16_t>(from);
    case PlyType::kUint16: return load_as<std::uint16_t>(from);
    case PlyType::kInt32: return load_as<std::int32_t>(from);
    case PlyType::kUint32: return load_as<std::uint32_t>(from);
    case PlyType::kFloat32: return load_as<float>(from);
    case PlyType::kFloat64: return load_as<double>(from);
  }
  return 0;
}

void ply_store(PlyType type, double value, std::uint8_t* to) {
  switch (type) {
    case PlyType::kInt8: return store_integer<std::int8_t>(value, to);
    case PlyType::kUint8: return store_integer<std::uint8_t>(value, to);
    case PlyType::kInt16: return store_integer<std::int16_t>(value, to);
    case PlyType::kUint16: return store_integer<std::uint16_t>(value, to);
    case PlyType::kInt32: return store_integer<std::int32_t>(value, to);
    case PlyType::kUint32: return store_integer<std::uint32_t>(value, to);
    case PlyType::kFloat32: return ply_store_float(float(value), to);
    case PlyType::kFloat64: std::memcpy(to, &value, sizeof value); return;
  }
}

}  // namespace ngs::io
