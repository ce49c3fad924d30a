#include "ngs/io/capture/sparse_points.h"

#include <cmath>

#include "ngs/core/parse_number.h"
#include "ngs/io/files/byte_reader.h"
#include "ngs/io/files/text_lines.h"
#include "ngs/io/ply/ply.h"

namespace ngs::io {
namespace {

constexpr std::size_t kBinaryRecordBytes = 8 + 24 + 3 + 8 + 8;  // without its track

void check_finite(const SparsePoint& point, const std::string& where) {
  const Vec3<double> p = point.position;
  if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
    throw Error(ErrorCode::kBadInput, where + ": a position is not finite, expected three numbers");
}

std::vector<SparsePoint> parse_binary(Bytes bytes, const std::string& object) {
  ByteReader reader(bytes, object);
  std::vector<SparsePoint> points(reader.read_count(kBinaryRecordBytes));
  for (std::size_t i = 0; i < points.size(); ++i) {
    reader.skip(8);
    SparsePoint& point = points[i];
    point.position.x = reader.read<double>();
    point.position.y = reader.read<double>();
    point.position.z = reader.read<double>();
    for (std::uint8_t& c : point.rgb) c = reader.read<std::uint8_t>();
    reader.skip(8);
    reader.skip(8 * reader.read_count(8));
    check_finite(point, object + ": point " + std::to_string(i));
  }
  return points;
}

/// Parses one record "ID X Y Z R G B ERROR TRACK…"; false if the line is not one.
bool parse_record(std::string_view line, SparsePoint& point) {
  double values[8];
  const char *at = line.data(), *end = at + line.size();
  for (double& value : values) {
    while (at < end && (*at == ' ' || *at == '\t')) ++at;
    const auto [stop, error] = scan_number(at, end, value);
    if (error != std::errc() || (stop < end && *stop != ' ' && *stop != '\t' && *stop != '\r')) return false;
    at = stop;
  }
  point.position = {values[1], values[2], values[3]};
  for (int c = 0; c < 3; ++c) {
    if (!(values[4 + c] >= 0 && values[4 + c] <= 255)) return false;
    point.rgb[c] = std::uint8_t(values[4 + c]);
  }
  return true;
}

std::vector<SparsePoint> parse_text(std::string_view text, const std::string& object) {
  std::vector<SparsePoint> points;
  std::size_t number = 0;
  text = without_byte_order_mark(text);
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    ++number;
    const std::size_t first = line.find_first_not_of(" \t\r");
    if (first == std::string_view::npos || line[first] == '#') continue;
    SparsePoint point;
    const std::string where = object + ": line " + std::to_string(number);
    if (!parse_record(line, point))
      throw Error(ErrorCode::kBadInput, where + ": no point, expected ID X Y Z R G B ERROR TRACK",
                  "give COLMAP's points3D.txt, points3D.bin or a PLY with x y z");
    check_finite(point, where);
    points.push_back(point);
  }
  return points;
}

std::vector<SparsePoint> parse_ply(const std::string& path, Bytes bytes) {
  const PlyFile file = PlyFile::parse(path, bytes);
  const PlyElement* vertex = file.find("vertex");
  if (vertex == nullptr) throw Error(ErrorCode::kBadInput, path + ": no element 'vertex', expected points");
  const PlyTable table = file.table(*vertex);
  const PlyColumn position[3] = {table.column("x"), table.column("y"), table.column("z")};
  const PlyColumn colour[3] = {table.column("red"), table.column("green"), table.column("blue")};
  if (!position[0] || !position[1] || !position[2])
    throw Error(ErrorCode::kBadInput, path + ": vertex has no properties x y z, expected points");
  std::vector<SparsePoint> points(static_cast<std::size_t>(table.rows));
  for (std::int64_t i = 0; i < table.rows; ++i) {
    SparsePoint& point = points[std::size_t(i)];
    point.position = {position[0].value(i), position[1].value(i), position[2].value(i)};
    check_finite(point, path + ": point " + std::to_string(i));
    for (int c = 0; c < 3; ++c)
      if (colour[c]) ply_store(PlyType::kUint8, colour[c].value(i), &point.rgb[c]);
  }
  return points;
}

}  // namespace

std::vector<SparsePoint> parse_points(Bytes bytes, const std::string& object) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (text.starts_with("ply")) return parse_ply(object, bytes);
  // A binary file begins with a 64-bit count, whose high bytes are NUL for any plausible number of points.
  const bool binary = text.substr(0, 8).find('\0') != std::string_view::npos;
  return binary ? parse_binary(bytes, object) : parse_text(text, object);
}

std::vector<SparsePoint> read_points(const std::string& path) {
  const MappedFile file(path);
  return parse_points(file.bytes(), path);
}

}  // namespace ngs::io
