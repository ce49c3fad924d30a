#include "ngs/io/files/safetensors.h"

#include <algorithm>
#include <cstring>
#include <limits>

#include "ngs/core/check.h"
#include "ngs/core/error.h"
#include "ngs/io/files/atomic_file.h"
#include "ngs/io/files/json_file.h"

namespace ngs::io {
namespace {

constexpr std::uint64_t kMaxHeaderBytes = 100'000'000;  // the limit of the reference implementation

struct TypeInfo {
  TensorType type;
  const char* name;
  std::size_t bytes;
};
constexpr TypeInfo kTypes[] = {{TensorType::kU8, "U8", 1},   {TensorType::kU32, "U32", 4}, {TensorType::kI32, "I32", 4},
                               {TensorType::kU64, "U64", 8}, {TensorType::kI64, "I64", 8}, {TensorType::kF32, "F32", 4},
                               {TensorType::kF64, "F64", 8}};
const TypeInfo& info(TensorType type) { return kTypes[std::size_t(type)]; }

[[noreturn]] void bad(const std::string& name, const std::string& message) {
  throw Error(ErrorCode::kBadInput, name + ": " + message);
}

std::string shape_text(const std::vector<std::int64_t>& shape) {
  std::string text = "[";
  for (std::size_t k = 0; k < shape.size(); ++k) {
    if (k > 0) text += ", ";
    text += shape[k] < 0 ? "any" : std::to_string(shape[k]);
  }
  return text + "]";
}

/// Size of a tensor in bytes; limit + 1 if it exceeds `limit`.
std::uint64_t tensor_bytes(const std::vector<std::int64_t>& shape, std::size_t element_bytes, std::uint64_t limit) {
  if (std::find(shape.begin(), shape.end(), 0) != shape.end()) return 0;
  std::uint64_t bytes = element_bytes;
  for (const std::int64_t n : shape) {
    if (std::uint64_t(n) > limit / bytes) return limit + 1;
    bytes *= std::uint64_t(n);
  }
  return bytes;
}

struct Placed {
  Tensor tensor;
  std::uint64_t begin, end;
};

Placed parse_entry(const std::string& where, const std::string& key, const nlohmann::json& value, std::uint64_t limit) {
  const JsonReader reader(value, where + ": tensor '" + key + "'");
  Placed placed{};
  placed.tensor.name = key;
  const std::string dtype = reader.text("dtype");
  const auto type =
      std::find_if(std::begin(kTypes), std::end(kTypes), [&](const TypeInfo& t) { return t.name == dtype; });
  if (type == std::end(kTypes)) reader.fail("dtype", "U8, U32, I32, U64, I64, F32 or F64");
  placed.tensor.type = type->type;
  for (const auto& n : reader.array("shape")) {
    if (!n.is_number_unsigned() || n.get<std::uint64_t>() > std::uint64_t(std::numeric_limits<std::int64_t>::max()))
      reader.fail("shape", "whole numbers >= 0");
    placed.tensor.shape.push_back(n.get<std::int64_t>());
  }
  const auto& offsets = reader.array("data_offsets");
  if (offsets.size() != 2 || !offsets[0].is_number_unsigned() || !offsets[1].is_number_unsigned())
    reader.fail("data_offsets", "[begin, end]");
  placed.begin = offsets[0].get<std::uint64_t>();
  placed.end = offsets[1].get<std::uint64_t>();
  if (placed.begin > placed.end || placed.end > limit)
    reader.fail("data_offsets", "begin <= end <= " + std::to_string(limit) + ", the bytes after the header");
  if (tensor_bytes(placed.tensor.shape, type->bytes, limit) != placed.end - placed.begin)
    reader.fail("data_offsets", "as many bytes as shape " + shape_text(placed.tensor.shape) + " needs");
  return placed;
}

void parse_metadata(const std::string& name, const nlohmann::json& value, TensorFile& file) {
  if (!value.is_object()) bad(name, "__metadata__ is not an object, expected {string: string}");
  for (const auto& [key, text] : value.items()) {
    if (!text.is_string()) bad(name, "__metadata__ '" + key + "' is not a string");
    file.metadata[key] = text.get<std::string>();
  }
}

}  // namespace

bool TensorFile::has(std::string_view tensor) const {
  return std::any_of(tensors.begin(), tensors.end(), [&](const Tensor& t) { return t.name == tensor; });
}

const Tensor& TensorFile::find(std::string_view tensor, TensorType type, const std::vector<std::int64_t>& shape) const {
  for (const Tensor& t : tensors) {
    if (t.name != tensor) continue;
    if (t.type != type) bad(name, "tensor '" + t.name + "' is " + info(t.type).name + ", expected " + info(type).name);
    bool fits = shape.empty() || shape.size() == t.shape.size();
    for (std::size_t k = 0; fits && k < shape.size(); ++k) fits = shape[k] < 0 || shape[k] == t.shape[k];
    if (!fits)
      bad(name, "tensor '" + t.name + "' has shape " + shape_text(t.shape) + ", expected " + shape_text(shape));
    return t;
  }
  bad(name, "no tensor '" + std::string(tensor) + "' (found " + std::to_string(tensors.size()) + " others)");
}

const std::string& TensorFile::meta(const std::string& key) const {
  const auto found = metadata.find(key);
  if (found == metadata.end()) bad(name, "no metadata '" + key + "'");
  return found->second;
}

void TensorFile::add_bytes(std::string tensor, TensorType type, std::vector<std::int64_t> shape, const void* data,
                           std::size_t bytes) {
  NGS_CHECK(!has(tensor) && tensor != "__metadata__", "tensor name '" + tensor + "' is taken");
  NGS_CHECK(tensor_bytes(shape, info(type).bytes, bytes) == bytes, "tensor '" + tensor + "': shape and size differ");
  const auto* from = static_cast<const std::uint8_t*>(data);
  tensors.push_back({std::move(tensor), type, std::move(shape), {from, from + bytes}});
}

void TensorFile::copy_bytes(const Tensor& tensor, void* to) {
  if (!tensor.bytes.empty()) std::memcpy(to, tensor.bytes.data(), tensor.bytes.size());
}

TensorFile read_safetensors(const std::string& path) { return parse_safetensors(path, MappedFile(path).bytes()); }

TensorFile parse_safetensors(std::string name, Bytes bytes) {
  std::uint64_t header_bytes = 0;
  if (bytes.size() < 8) bad(name, std::to_string(bytes.size()) + " bytes, expected a safetensors file");
  std::memcpy(&header_bytes, bytes.data(), 8);
  if (header_bytes > kMaxHeaderBytes || header_bytes > bytes.size() - 8)
    bad(name, "a header of " + std::to_string(header_bytes) + " bytes in a file of " + std::to_string(bytes.size()) +
                  ", expected a complete safetensors file");
  const std::string_view header(reinterpret_cast<const char*>(bytes.data()) + 8, header_bytes);
  const Bytes data = bytes.subspan(8 + header_bytes);
  const nlohmann::json json = parse_json(header, name);
  if (!json.is_object()) bad(name, "the header is not a JSON object, expected a safetensors file");

  TensorFile file;
  std::vector<Placed> placed;
  for (const auto& [key, value] : json.items()) {
    if (key == "__metadata__")
      parse_metadata(name, value, file);
    else
      placed.push_back(parse_entry(name, key, value, data.size()));
  }
  // Only empty tensors compare equal; JSON objects are sorted by name, so the order is deterministic.
  std::stable_sort(placed.begin(), placed.end(), [](const Placed& a, const Placed& b) {
    return a.begin != b.begin ? a.begin < b.begin : a.end < b.end;
  });
  std::uint64_t at = 0;
  for (Placed& p : placed) {
    if (p.begin != at)
      bad(name, "tensor '" + p.tensor.name + "' begins at byte " + std::to_string(p.begin) + ", expected " +
                    std::to_string(at) + " (no gaps, no overlaps)");
    at = p.end;
    const Bytes values = data.subspan(p.begin, p.end - p.begin);
    p.tensor.bytes.assign(values.begin(), values.end());
    file.tensors.push_back(std::move(p.tensor));
  }
  if (at != data.size())
    bad(name, std::to_string(data.size()) + " bytes after the header, expected " + std::to_string(at));
  file.name = std::move(name);
  return file;
}

void write_safetensors(const std::string& path, const TensorFile& file) {
  std::vector<const Tensor*> order;
  for (const Tensor& t : file.tensors) order.push_back(&t);
  std::stable_sort(order.begin(), order.end(),
                   [](const Tensor* a, const Tensor* b) { return info(a->type).bytes > info(b->type).bytes; });
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  if (!file.metadata.empty()) json["__metadata__"] = file.metadata;
  std::uint64_t at = 0;
  for (const Tensor* t : order) {
    json[t->name] = {{"dtype", info(t->type).name}, {"shape", t->shape}, {"data_offsets", {at, at + t->bytes.size()}}};
    at += t->bytes.size();
  }
  std::string header = json.dump(-1, ' ', true, nlohmann::ordered_json::error_handler_t::replace);
  header.resize((header.size() + 7) / 8 * 8, ' ');  // aligns the values in a memory mapping
  const std::uint64_t header_bytes = header.size();
  AtomicFile out(path);
  out.write(&header_bytes, 8);
  out.write(header);
  for (const Tensor* t : order) out.write(t->bytes.data(), t->bytes.size());
  out.commit();
}

}  // namespace ngs::io
