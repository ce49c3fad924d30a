#pragma once
// Named arrays in the safetensors format, which Python's safetensors package reads: u64 header length, a JSON header
// {name: {dtype, shape, data_offsets}, "__metadata__": {string: string}}, then the raw little-endian values without
// gaps. Used for NeRF parameters, checkpoints and partial evidence.
//
// The reader checks everything against the file size before it allocates; malformed files are kBadInput.
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ngs/io/files/mapped_file.h"

namespace ngs::io {

enum class TensorType : std::uint8_t { kU8, kU32, kI32, kU64, kI64, kF32, kF64 };

template <class T>
struct TensorTypeOf;
template <>
struct TensorTypeOf<std::uint8_t> {
  static constexpr TensorType value = TensorType::kU8;
};
template <>
struct TensorTypeOf<std::uint32_t> {
  static constexpr TensorType value = TensorType::kU32;
};
template <>
struct TensorTypeOf<std::int32_t> {
  static constexpr TensorType value = TensorType::kI32;
};
template <>
struct TensorTypeOf<std::uint64_t> {
  static constexpr TensorType value = TensorType::kU64;
};
template <>
struct TensorTypeOf<std::int64_t> {
  static constexpr TensorType value = TensorType::kI64;
};
template <>
struct TensorTypeOf<float> {
  static constexpr TensorType value = TensorType::kF32;
};
template <>
struct TensorTypeOf<double> {
  static constexpr TensorType value = TensorType::kF64;
};

struct Tensor {
  std::string name;
  TensorType type = TensorType::kF32;
  std::vector<std::int64_t> shape;
  std::vector<std::uint8_t> bytes;  // row-major
};

struct TensorFile {
  std::string name;  // file name, for messages
  std::vector<Tensor> tensors;
  std::map<std::string, std::string> metadata;

  template <class T>
  void add(std::string tensor, std::vector<std::int64_t> shape, std::span<const T> values) {
    add_bytes(std::move(tensor), TensorTypeOf<T>::value, std::move(shape), values.data(), values.size_bytes());
  }
  template <class T>
  void add(std::string tensor, std::vector<std::int64_t> shape, const std::vector<T>& values) {
    add(std::move(tensor), std::move(shape), std::span<const T>(values));
  }
  bool has(std::string_view tensor) const;
  /// A copy of the values. kBadInput if the tensor is absent, has another type or, if `shape` is given, another shape;
  /// -1 in `shape` accepts any size.
  template <class T>
  std::vector<T> get(std::string_view tensor, const std::vector<std::int64_t>& shape = {}) const {
    const Tensor& found = find(tensor, TensorTypeOf<T>::value, shape);
    std::vector<T> values(found.bytes.size() / sizeof(T));
    copy_bytes(found, values.data());
    return values;
  }
  /// kBadInput if it is absent.
  const std::string& meta(const std::string& key) const;

 private:
  void add_bytes(std::string tensor, TensorType type, std::vector<std::int64_t> shape, const void* data,
                 std::size_t bytes);
  const Tensor& find(std::string_view tensor, TensorType type, const std::vector<std::int64_t>& shape) const;
  static void copy_bytes(const Tensor& tensor, void* to);
};

TensorFile read_safetensors(const std::string& path);
TensorFile parse_safetensors(std::string name, Bytes bytes);

/// Atomic. Tensors are sorted by decreasing element size, then in their order; equal input gives equal bytes.
void write_safetensors(const std::string& path, const TensorFile& file);

}  // namespace ngs::io
