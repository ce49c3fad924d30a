#pragma once
// The PLY container: any element, any scalar type, ascii and both byte orders. Each element is read as a table of
// packed little-endian rows whose columns are found by property name; the meaning of a property is up to the caller.
//
// Every count of a header is checked against the file size before memory is allocated. A file that is truncated at any
// place is kBadInput, with what was found and expected. An ascii file must end in a newline, because a truncation of
// "1.25" to "1.2" could not be detected otherwise.
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "ngs/io/files/mapped_file.h"
#include "ngs/io/ply/ply_types.h"

namespace ngs::io {

class AtomicFile;

/// A parsed file. Owns the mapping: tables that borrow from it are valid during its lifetime.
class PlyFile {
 public:
  static PlyFile open(const std::string& path);
  static PlyFile parse(std::string name, MappedFile mapped);
  /// The same from a buffer that outlives the result. `name` is for messages.
  static PlyFile parse(std::string name, Bytes bytes);
  /// Parses elements and comments only; the rows may be missing.
  static PlyFile header_of(const std::string& path);
  /// Stands for a file of another format, whose rows are decoded elsewhere: a name without elements.
  static PlyFile named(std::string name);

  const std::string& name() const { return name_; }
  PlyFormat format() const { return format_; }
  const std::vector<std::string>& comments() const { return comments_; }  // without "comment "; obj_info too
  const std::vector<PlyElement>& elements() const { return elements_; }
  const PlyElement* find(std::string_view element) const;  // null: none

  /// Call before a pass over the rows, and during it, to keep only a part of the file in memory.
  void forget_pages() const { mapped_.forget_pages(); }

  /// Converts if necessary (ascii, big-endian, lists); plain little-endian rows are borrowed without a copy.
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

/// Writes one element as binary little-endian rows, streaming and atomically (atomic_file.h). Comments follow the
/// properties, because a well-known viewer takes the third line as the vertex count without checking.
class PlyWriter {
 public:
  PlyWriter(const std::string& path, const PlyElement& element, const std::vector<std::string>& comments);
  ~PlyWriter();

  /// The next row, to be filled completely before the next call. Must be called exactly element.count times.
  std::uint8_t* row();
  void commit();

 private:
  void flush();

  std::unique_ptr<AtomicFile> file_;
  std::vector<std::uint8_t> buffer_;
  std::size_t row_bytes_ = 0, used_ = 0;
  std::int64_t rows_left_ = 0;
};

}  // namespace ngs::io
