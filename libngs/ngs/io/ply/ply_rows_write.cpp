#include "ngs/io/ply/ply_rows_write.h"

#include <algorithm>
#include <cstring>

#include "ngs/core/check.h"

namespace ngs::io {
namespace {

/// A stretch of a row that is copied at once.
struct Stretch {
  std::size_t offset = 0, bytes = 0;
};

std::vector<Stretch> stretches_of(const PlyTable& rows, const std::string& replaced,
                                  std::vector<PlyProperty>& properties) {
  std::vector<Stretch> stretches;
  for (std::size_t p = 0; p < rows.properties.size(); ++p) {
    if (rows.properties[p].name == replaced) continue;
    properties.push_back(rows.properties[p]);
    const std::size_t bytes = ply_type_bytes(rows.properties[p].type);
    if (!stretches.empty() && stretches.back().offset + stretches.back().bytes == rows.offset[p])
      stretches.back().bytes += bytes;
    else
      stretches.push_back({rows.offset[p], bytes});
  }
  return stretches;
}

}  // namespace

void write_ply_rows(const std::string& path, const GaussianPly& source, const std::vector<std::uint8_t>& keep,
                    const std::optional<AddedColumn>& added) {
  const std::size_t n = std::size_t(source.cloud.size());
  NGS_CHECK(keep.size() == n && (!added || added->values.size() == n), "one entry per Gaussian");
  PlyElement element;
  element.name = "vertex";
  element.count = std::int64_t(std::ranges::count_if(keep, [](std::uint8_t k) { return k != 0; }));
  const std::vector<Stretch> stretches = stretches_of(source.rows, added ? added->name : "", element.properties);
  if (added) element.properties.push_back({.name = added->name});
  PlyWriter writer(path, element, source.comments);
  constexpr std::size_t kRowsAtOnce = 1 << 17;
  for (std::size_t i = 0; i < n; ++i) {
    if (i % kRowsAtOnce == 0) source.file.forget_pages();
    if (!keep[i]) continue;
    const std::uint8_t* row = source.rows.row(std::int64_t(i));
    std::uint8_t* to = writer.row();
    for (const Stretch& stretch : stretches) {
      std::memcpy(to, row + stretch.offset, stretch.bytes);
      to += stretch.bytes;
    }
    if (added) ply_store_float(added->values[i], to);
  }
  writer.commit();
}

}  // namespace ngs::io
