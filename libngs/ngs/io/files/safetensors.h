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
#include <type_traits>
#include <vector>

#include "ngs/io/files/mapped_file.h"

namespace ngs::io {

enum class TensorType : std::uint8_t { kU8, kU32, kI32, kU64, kI64, kF32, kF64 };

template <class T>
constexpr TensorType tensor_type_of() {
  if constexpr (std::is_same_v<T, std::uint8_t>) return TensorType::kU8;
  if constexpr (std::is_same_v<T, std::uint32_t>) return TensorType::kU32;
  if constexpr (std::is_same_v<T, std::int32_t>) return TensorType::kI32;
  if constexpr (std::is_same_v<T, std::uint64_t>) return TensorType::kU64;
  if constexpr (std::is_same_v<T, std::int64_t>) return TensorType::kI64;
  if constexpr (std::is_same_v<T, float>) return TensorType::kF32;
  if constexpr (std::is_same_v<T, double>) return TensorType::kF64;
}

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
  void add(const std::string& tensor, const std::vector<std::int64_t>& shape, std::span<const T> values) {
    add_bytes(tensor, tensor_type_of<T>(), shape, values.data(), values.size_bytes());
  }
  template <class T>
  void add(const std::string& tensor, const std::vector<std::int64_t>& shape, const std::vector<T>& values) {
    add(tensor, shape, std::span<const T>(values));
  }
  bool has(std::string_view tensor) const;
  /// A copy of the values. kBadInput if the tensor is absent, has another type or, if `shape` is given, another shape;
  /// -1 in `shape` accepts any size.
  template <class T>
  std::vector<T> get(std::string_view tensor, const std::vector<std::int64_t>& shape = {}) const {
    const Tensor& found = find(tensor, tensor_type_of<T>(), shape);
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
