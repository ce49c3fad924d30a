#include "support/mutations.h"

#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>

#include "ngs/io/image/image_file.h"
#include "support/temp_dir.h"

namespace ngs::test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

void require(bool fits, const Json& step) {
  if (!fits) throw std::runtime_error("the step does not fit: " + step.dump());
}

void write_bytes(const std::string& path, const std::string& bytes) {
  if (fs::path(path).has_parent_path()) fs::create_directories(fs::path(path).parent_path());
  std::ofstream(path, std::ios::binary) << bytes;
}

double number(const Json& value) {
  if (value.is_number()) return value.get<double>();
  if (value == "nan") return std::numeric_limits<double>::quiet_NaN();
  return (value == "-inf" ? -1 : 1) * std::numeric_limits<double>::infinity();
}

struct Column {
  std::size_t header_bytes = 0, rows = 0, row_bytes = 0, offset = 0;
  bool found = false;
};

/// Where a float property of the first element of a little-endian PLY lies.
Column find_column(const std::string& ply, const std::string& name) {
  Column column{.header_bytes = ply.find("end_header\n") + std::strlen("end_header\n")};
  std::istringstream header(ply.substr(0, column.header_bytes));
  int elements = 0;
  for (std::string line; std::getline(header, line);) {
    std::istringstream words(line);
    std::string word, type, property;
    words >> word >> type >> property;
    if (word == "element" && ++elements == 1) column.rows = std::stoull(property);
    if (word != "property" || elements != 1) continue;
    if (property == name) {
      column.offset = column.row_bytes;
      column.found = type == "float";
    }
    const bool byte = type == "uchar" || type == "char", pair = type == "ushort" || type == "short";
    column.row_bytes += byte ? 1 : pair ? 2 : type == "double" ? 8 : 4;
  }
  return column;
}

void poke(const Json& step) {
  const std::string path = step["poke"];
  std::string ply = read_bytes(path);
  const Column column = find_column(ply, step["property"]);
  require(column.found, step);
  const float value = float(number(step["value"]));
  const std::size_t first = step.value("row", std::size_t(0)), last = step.contains("row") ? first + 1 : column.rows;
  require(last <= column.rows && column.header_bytes + last * column.row_bytes <= ply.size(), step);
  for (std::size_t row = first; row < last; ++row)
    std::memcpy(ply.data() + column.header_bytes + row * column.row_bytes + column.offset, &value, sizeof value);
  write_bytes(path, ply);
}

void replace_text(const Json& step) {
  std::string text = read_bytes(step["replace"]);
  const std::string from = step["from"], to = step["to"];
  const std::size_t at = text.find(from);
  require(at != text.npos, step);
  write_bytes(step["replace"], text.replace(at, from.size(), to));
}

void truncate(const Json& step) {
  const std::string path = step["truncate"];
  const auto size = std::int64_t(fs::file_size(path));
  std::int64_t bytes = step.contains("share") ? std::int64_t(double(size) * step["share"].get<double>())
                                              : step["bytes"].get<std::int64_t>();
  if (bytes < 0) bytes += size;
  require(bytes >= 0 && bytes < size, step);
  fs::resize_file(path, std::uintmax_t(bytes));
}

void overwrite_bytes(const Json& step) {
  std::string bytes = read_bytes(step["bytes"]);
  const std::string hex = step["hex"];
  const std::size_t at = step["at"];
  require(at + hex.size() / 2 <= bytes.size(), step);
  for (std::size_t i = 0; i < hex.size() / 2; ++i) bytes[at + i] = char(std::stoi(hex.substr(2 * i, 2), nullptr, 16));
  write_bytes(step["bytes"], bytes);
}

std::string text_of(const Json& step) {
  std::string text;
  for (int i = 0; i < step.value("times", 1); ++i) text += step["text"].get<std::string>();
  return text;
}

void invert_masks(const Json& step) {
  for (const fs::directory_entry& entry : fs::directory_iterator(step["negative"].get<std::string>())) {
    const io::RawMask mask = io::read_mask_raw(entry.path().string(), io::Palette::kMask);
    require(mask.channels == 1 && mask.bits == 8, step);
    ImageU8 image(mask.width_px, mask.height_px, 1);
    for (std::size_t i = 0; i < image.data.size(); ++i) image.data[i] = std::uint8_t(255 - mask.data[i]);
    io::write_png(entry.path().string(), image);
  }
}

void write_flat_png(const Json& step) {
  const ImageU8 image(step["size"][0], step["size"][1], step.value("channels", 1),
                      std::uint8_t(step["value"].get<int>()));
  fs::create_directories(fs::path(step["png"].get<std::string>()).parent_path());
  io::write_png(step["png"], image);
}

}  // namespace

void apply_mutation(const Json& step) {
  if (step.contains("truncate")) return truncate(step);
  if (step.contains("replace")) return replace_text(step);
  if (step.contains("poke")) return poke(step);
  if (step.contains("png")) return write_flat_png(step);
  if (step.contains("negative")) return invert_masks(step);
  if (step.contains("hex")) return overwrite_bytes(step);
  if (step.contains("resize"))
    return fs::resize_file(step["resize"].get<std::string>(), step["bytes"].get<std::uintmax_t>());
  if (step.contains("write")) return write_bytes(step["write"], text_of(step));
  if (step.contains("append")) return write_bytes(step["append"], read_bytes(step["append"]) + text_of(step));
  if (step.contains("remove")) return require(fs::remove_all(step["remove"].get<std::string>()) > 0, step);
  if (step.contains("mkdir")) return void(fs::create_directories(step["mkdir"].get<std::string>()));
  if (step.contains("copy"))
    return fs::copy(step["copy"].get<std::string>(), step["to"].get<std::string>(),
                    fs::copy_options::recursive | fs::copy_options::overwrite_existing);
  if (step.contains("link")) return fs::create_symlink(step["link"].get<std::string>(), step["to"].get<std::string>());
  require(false, step);
}

}  // namespace ngs::test
