#pragma once
// Builds PLY files in memory, in every format, from rows of numbers and named properties.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include "ngs/io/ply/ply.h"

namespace ngs::test {

struct PlyColumns {
  std::string element = "vertex";
  std::vector<std::pair<std::string, io::PlyType>> properties;
  std::vector<std::vector<double>> rows;
};

inline std::string ply_number(io::PlyType type, double value) {
  char text[40];
  std::snprintf(text, sizeof text, type == io::PlyType::kFloat64 ? "%.17g" : "%.9g", value);
  return text;
}

inline std::string ply_body(const PlyColumns& table, io::PlyFormat format, const std::string& end_of_line) {
  std::string body;
  for (const auto& row : table.rows) {
    for (std::size_t p = 0; p < row.size(); ++p) {
      const io::PlyType type = table.properties[p].second;
      if (format == io::PlyFormat::kAscii) {
        if (p > 0) body += ' ';
        body += ply_number(type, row[p]);
        continue;
      }
      std::uint8_t bytes[8];
      const std::size_t n = io::ply_type_bytes(type);
      io::ply_store(type, row[p], bytes);
      for (std::size_t k = 0; k < n; ++k) body += char(bytes[format == io::PlyFormat::kBinaryBig ? n - 1 - k : k]);
    }
    if (format == io::PlyFormat::kAscii) body += end_of_line;
  }
  return body;
}

/// A complete file with several elements. `extra` holds header lines (comments) without line ends.
inline std::string ply_bytes(const std::vector<PlyColumns>& elements, io::PlyFormat format,
                             const std::vector<std::string>& extra = {}, const std::string& end_of_line = "\n") {
  const char* names[] = {"ascii", "binary_little_endian", "binary_big_endian"};
  std::string file = "ply" + end_of_line + "format " + names[int(format)] + " 1.0" + end_of_line;
  for (const std::string& line : extra) file += line + end_of_line;
  for (const PlyColumns& e : elements) {
    file += "element " + e.element + " " + std::to_string(e.rows.size()) + end_of_line;
    for (const auto& [name, type] : e.properties)
      file += "property " + std::string(io::ply_type_name(type)) + " " + name + end_of_line;
  }
  file += "end_header" + end_of_line;
  for (const PlyColumns& e : elements) file += ply_body(e, format, end_of_line);
  return file;
}

inline io::Bytes as_bytes(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

/// A model of `n` Gaussians in the Inria layout of a degree; value (row, column) is a simple fixed number.
inline PlyColumns inria_columns(int n, int degree, bool normals = true, io::PlyType type = io::PlyType::kFloat32) {
  PlyColumns table;
  std::vector<std::string> names = {"x", "y", "z"};
  if (normals) names.insert(names.end(), {"nx", "ny", "nz"});
  names.insert(names.end(), {"f_dc_0", "f_dc_1", "f_dc_2"});
  for (int k = 0; k < 3 * ((degree + 1) * (degree + 1) - 1); ++k) names.push_back("f_rest_" + std::to_string(k));
  names.insert(names.end(), {"opacity", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"});
  for (const std::string& name : names) table.properties.push_back({name, type});
  for (int i = 0; i < n; ++i) {
    std::vector<double> row;
    for (std::size_t p = 0; p < names.size(); ++p)
      row.push_back(names[p][0] == 'n' ? 0.0 : 0.125 * double(p) - double(i) + 0.5);
    table.rows.push_back(row);
  }
  return table;
}

inline std::size_t column_of(const PlyColumns& table, const std::string& name) {
  const auto found =
      std::find_if(table.properties.begin(), table.properties.end(), [&](const auto& p) { return p.first == name; });
  return std::size_t(found - table.properties.begin());
}

inline void add_column(PlyColumns& table, std::size_t at, const std::string& name, io::PlyType type, double value) {
  table.properties.insert(table.properties.begin() + std::ptrdiff_t(at), {name, type});
  for (auto& row : table.rows) row.insert(row.begin() + std::ptrdiff_t(at), value);
}

inline void remove_column(PlyColumns& table, const std::string& name) {
  const auto at = std::ptrdiff_t(column_of(table, name));
  table.properties.erase(table.properties.begin() + at);
  for (auto& row : table.rows) row.erase(row.begin() + at);
}

}  // namespace ngs::test
