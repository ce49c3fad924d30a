#pragma once
// Copies rows of a table without some of its columns; neighbouring columns are copied in one block.
#include <cstring>
#include <vector>

#include "ngs/io/ply/ply_types.h"

namespace ngs::io {

class SelectedColumns {
 public:
  /// Columns of `rows` for which keep(name).
  template <class Keep>
  SelectedColumns(const PlyTable& rows, const Keep& keep) {
    for (std::size_t p = 0; p < rows.properties.size(); ++p)
      if (keep(rows.properties[p].name)) add(rows.properties[p], rows.offset[p]);
  }

  const std::vector<PlyProperty>& properties() const { return properties_; }
  std::size_t row_bytes() const { return row_bytes_; }
  void copy(const std::uint8_t* row, std::uint8_t* to) const {
    for (const Stretch& s : stretches_) {
      std::memcpy(to, row + s.offset, s.bytes);
      to += s.bytes;
    }
  }

 private:
  struct Stretch {
    std::size_t offset, bytes;
  };

  void add(const PlyProperty& property, std::size_t offset) {
    const std::size_t bytes = ply_type_bytes(property.type);
    properties_.push_back(property);
    row_bytes_ += bytes;
    if (!stretches_.empty() && stretches_.back().offset + stretches_.back().bytes == offset)
      stretches_.back().bytes += bytes;
    else
      stretches_.push_back({offset, bytes});
  }

  std::vector<PlyProperty> properties_;
  std::vector<Stretch> stretches_;
  std::size_t row_bytes_ = 0;
};

inline PlyTable copy_of(const PlyTable& from, const SelectedColumns& columns) {
  PlyTable to;
  to.set_properties(columns.properties());
  to.rows = from.rows;
  to.owned.resize(std::size_t(to.rows) * to.row_bytes);
  for (std::int64_t i = 0; i < from.rows; ++i)
    columns.copy(from.row(i), to.owned.data() + std::size_t(i) * to.row_bytes);
  return to;
}

}  // namespace ngs::io
