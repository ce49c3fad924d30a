#pragma once
// The PLY container: any element, any scalar type, ascii and both byte orders. Readers get each element as a
// table of packed little-endian rows, found by property name; what a property means is the caller's business.
//
// Every count of a header is checked against the bytes that are there before anything is allocated. A file
// that ends early, at any place, is kBadInput with what was found and what was expected; an ascii file must
// end in a newline, because "1.25" cut to "1.2" could not be told from a whole number otherwise.
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "ngs/io/files/mapped_file.h"
#include "ngs/io/ply/ply_types.h"

namespace ngs::io {

class AtomicFile;

/// A parsed file. Keeps the mapping alive, so tables that borrow from it are valid while it lives.
class PlyFile {
 public:
  static PlyFile open(const std::string& path);
  static PlyFile parse(std::string name, MappedFile mapped);
  /// The same on a buffer that outlives the result. `name` is for messages.
  static PlyFile parse(std::string name, Bytes bytes);
  /// Elements and comments alone: its rows need not be there.
  static PlyFile header_of(const std::string& path);
  /// A file of another format, whose rows are decoded elsewhere: its name and nothing in it.
  static PlyFile named(std::string name);

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

}  // namespace ngs::io
