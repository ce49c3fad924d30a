#pragma once
// The PLY container: any element, any scalar type, ascii and both byte orders. Readers get each element as a
// table of packed little-endian rows, found by property name; what a property means is the caller's business.
//
// Every count of a header is checked against the bytes that are there before anything is allocated. A file
// that ends early, at any place, is kBadInput with what was found and what was expected; an ascii file must
// end in a newline, because "1.25" cut to "1.2" could not be told from a whole number otherwise.
#include <cstdint>
#include <cstring>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "ngs/io/files/mapped_file.h"

namespace ngs::io {

class AtomicFile;

enum class PlyFormat : std::uint8_t { kAscii, kBinaryLittle, kBinaryBig };
enum class PlyType : std::uint8_t { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };

std::size_t ply_type_bytes(PlyType type);
std::string_view ply_type_name(PlyType type);  // "char" ... "double"

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

/// One column of a PlyTable. Values convert to double exactly; a float keeps its bits (NaN payloads too).
struct PlyColumn {
  const std::uint8_t* first = nullptr;  // null: no rows or no such property
  std::size_t stride = 0;               // bytes; 0: no such property
  PlyType type = PlyType::kFloat32;

  explicit operator bool() const { return stride > 0; }
  double value(std::int64_t row) const;
  float value_float(std::int64_t row) const;
};

/// The scalar properties of one element (lists are left out), rows packed without padding, little-endian.
struct PlyTable {
  std::vector<PlyProperty> properties;
  std::vector<std::size_t> offset;  // [properties] byte offset in a row
  std::size_t row_bytes = 0;
  std::int64_t rows = 0;
  const std::uint8_t* borrowed = nullptr;  // into the file, where its rows already are of this form
  std::vector<std::uint8_t> owned;         // else converted

  const std::uint8_t* row(std::int64_t i) const {
    return (owned.empty() ? borrowed : owned.data()) + std::size_t(i) * row_bytes;
  }
  int find(std::string_view name) const;  // -1: none
  PlyColumn column(std::string_view name) const;
  void set_properties(std::vector<PlyProperty> scalar_properties);  // and offset, row_bytes
};

/// A parsed file. Keeps the mapping alive, so tables that borrow from it are valid while it lives.
class PlyFile {
 public:
  static PlyFile open(const std::string& path);
  /// The same on a buffer that outlives the result. `name` is for messages.
  static PlyFile parse(std::string name, Bytes bytes);

  const std::string& name() const { return name_; }
  PlyFormat format() const { return format_; }
  const std::vector<std::string>& comments() const { return comments_; }  // without "comment "; obj_info too
  const std::vector<PlyElement>& elements() const { return elements_; }
  const PlyElement* find(std::string_view element) const;  // null: none

  /// A pass over the rows that calls this now and then holds only a part of the file in memory.
  void forget_pages() const { mapped_.forget_pages(); }

  /// Converts where needed (ascii, big-endian, lists); costs nothing for plain little-endian rows.
  PlyTable table(const PlyElement& element) const;

 private:
  void parse_header();
  void locate_elements();

  std::string name_;
  MappedFile mapped_;
  Bytes bytes_;
  std::size_t body_ = 0;
  PlyFormat format_ = PlyFormat::kBinaryLittle;
  std::vector<std::string> comments_;
  std::vector<PlyElement> elements_;
};

/// Writes one element as binary little-endian rows, streaming, by rename (atomic_file.h).
/// Comments follow the properties: a well-known viewer takes the third line for the vertex count unread.
class PlyWriter {
 public:
  PlyWriter(const std::string& path, const PlyElement& element, const std::vector<std::string>& comments);
  ~PlyWriter();

  /// The next row, to be filled completely before the next call. Exactly element.count rows.
  std::uint8_t* row();
  void commit();

 private:
  void flush();

  std::unique_ptr<AtomicFile> file_;
  std::vector<std::uint8_t> buffer_;
  std::size_t row_bytes_ = 0, used_ = 0;
  std::int64_t rows_left_ = 0;
};

/// Stores `value` as `type` at `to`; integers are rounded and saturated, NaN becomes 0 there.
void ply_store(PlyType type, double value, std::uint8_t* to);
inline void ply_store_float(float value, std::uint8_t* to) { std::memcpy(to, &value, sizeof value); }

inline float PlyColumn::value_float(std::int64_t row) const {
  if (type != PlyType::kFloat32) return float(value(row));
  float v;
  std::memcpy(&v, first + std::size_t(row) * stride, sizeof v);
  return v;
}

}  // namespace ngs::io
