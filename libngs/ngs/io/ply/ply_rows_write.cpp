#include "ngs/io/ply/ply_rows_write.h"

#include <algorithm>

#include "ngs/core/check.h"
#include "ngs/io/ply/selected_columns.h"

namespace ngs::io {

void write_ply_rows(const std::string& path, const GaussianPly& source, const std::vector<std::uint8_t>& keep,
                    const std::optional<AddedColumn>& added) {
  const std::size_t n = std::size_t(source.cloud.size());
  NGS_CHECK(keep.size() == n && (!added || added->values.size() == n), "one entry per Gaussian");
  PlyElement element;
  element.name = "vertex";
  element.count = std::int64_t(std::ranges::count_if(keep, [](std::uint8_t k) { return k != 0; }));
  const SelectedColumns kept(source.rows, [&](const std::string& name) { return !added || name != added->name; });
  element.properties = kept.properties();
  if (added) element.properties.push_back({.name = added->name});
  PlyWriter writer(path, element, source.comments);
  constexpr std::size_t kRowsAtOnce = 1 << 17;
  for (std::size_t i = 0; i < n; ++i) {
    if (i % kRowsAtOnce == 0) source.file.forget_pages();
    if (!keep[i]) continue;
    std::uint8_t* to = writer.row();
    kept.copy(source.rows.row(std::int64_t(i)), to);
    if (added) ply_store_float(added->values[i], to + kept.row_bytes());
  }
  writer.commit();
}

}  // namespace ngs::io
