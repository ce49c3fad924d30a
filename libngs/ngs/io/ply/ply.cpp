#include "ngs/io/ply/ply.h"

#include <algorithm>
#include <charconv>
#include <optional>

#include "ngs/core/check.h"
#include "ngs/core/error.h"
#include "ngs/io/files/atomic_file.h"
#include "ngs/io/ply/ply_scan.h"

namespace ngs::io {
namespace {

constexpr std::size_t kMaxHeaderBytes = std::size_t(1) << 24;
// Names are compared pairwise: time is quadratic in these limits; a model of ngs has 5 properties per object.
constexpr std::size_t kMaxElements = 256, kMaxProperties = 16384;

[[noreturn]] void bad(const std::string& name, const std::string& message, std::string remedy = {}) {
  throw Error(ErrorCode::kBadInput, name + ": " + message, std::move(remedy));
}

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> words;
  for (std::size_t i = 0; i < line.size();) {
    const std::size_t begin = line.find_first_not_of(" \t", i);
    if (begin == std::string_view::npos) break;
    const std::size_t end = std::min(line.find_first_of(" \t", begin), line.size());
    words.push_back(line.substr(begin, end - begin));
    i = end;
  }
  return words;
}

PlyType parse_type(const std::string& name, std::string_view word) {
  if (const std::optional<PlyType> type = ply_type_of(word)) return *type;
  bad(name, "property type '" + printable(word) +
                "', expected char uchar short ushort int uint float double (or int8 ... float64)");
}

PlyProperty parse_property(const std::string& name, const std::vector<std::string_view>& words) {
  PlyProperty property;
  const bool list = words.size() == 5 && words[1] == "list";
  if (!list && words.size() != 3)
    bad(name, "property line of " + std::to_string(words.size()) + " words, expected 'property TYPE NAME'");
  property.is_list = list;
  if (list) property.count_type = parse_type(name, words[2]);
  if (list && property.count_type >= PlyType::kFloat32)
    bad(name, "list '" + printable(words[4]) + "' counts in " + std::string(words[2]) + ", expected an integer type");
  property.type = parse_type(name, words[list ? 3 : 1]);
  property.name = std::string(words[list ? 4 : 2]);
  return property;
}

void add_property(const std::string& name, std::vector<PlyElement>& elements, PlyProperty property) {
  if (elements.empty()) bad(name, "property '" + printable(property.name) + "' before any element");
  auto& properties = elements.back().properties;
  for (const PlyProperty& p : properties)
    if (p.name == property.name)
      bad(name, "element '" + elements.back().name + "' has property '" + printable(property.name) +
                    "' twice, expected once");
  properties.push_back(std::move(property));
}

PlyElement parse_element(const std::string& name, const std::vector<std::string_view>& words) {
  if (words.size() != 3)
    bad(name, "element line of " + std::to_string(words.size()) + " words, expected 'element NAME COUNT'");
  PlyElement element;
  element.name = std::string(words[1]);
  const char* end = words[2].data() + words[2].size();
  const auto [stop, status] = std::from_chars(words[2].data(), end, element.count);
  if (status != std::errc() || stop != end || element.count < 0)
    bad(name,
        "element '" + printable(words[1]) + "' has count '" + printable(words[2]) + "', expected a whole number >= 0");
  return element;
}

PlyFormat parse_format(const std::string& name, const std::vector<std::string_view>& words) {
  if (words.size() == 3 && words[2] == "1.0") {
    if (words[1] == "ascii") return PlyFormat::kAscii;
    if (words[1] == "binary_little_endian") return PlyFormat::kBinaryLittle;
    if (words[1] == "binary_big_endian") return PlyFormat::kBinaryBig;
  }
  bad(name, "unknown format line, expected 'format ascii|binary_little_endian|binary_big_endian 1.0'");
}

constexpr std::size_t kBufferBytes = std::size_t(1) << 20;

}  // namespace

PlyFile PlyFile::open(const std::string& path) { return parse(path, MappedFile(path)); }

PlyFile PlyFile::parse(std::string name, MappedFile mapped) {
  PlyFile file;
  file.name_ = std::move(name);
  file.mapped_ = std::move(mapped);
  file.bytes_ = file.mapped_.bytes();
  file.parse_header();
  file.locate_elements();
  return file;
}

PlyFile PlyFile::parse(std::string name, Bytes bytes) {
  PlyFile file;
  file.name_ = std::move(name);
  file.bytes_ = bytes;
  file.parse_header();
  file.locate_elements();
  return file;
}

PlyFile PlyFile::header_of(const std::string& path) {
  const MappedFile mapped(path);
  PlyFile file;
  file.name_ = path;
  file.bytes_ = mapped.bytes();
  file.parse_header();
  file.bytes_ = {};
  return file;
}

PlyFile PlyFile::named(std::string name) {
  PlyFile file;
  file.name_ = std::move(name);
  return file;
}

const PlyElement* PlyFile::find(std::string_view element) const {
  for (const PlyElement& e : elements_)
    if (e.name == element) return &e;
  return nullptr;
}

void PlyFile::parse_header() {
  const std::string_view text(reinterpret_cast<const char*>(bytes_.data()), bytes_.size());
  if (!text.starts_with("ply\n") && !text.starts_with("ply\r\n"))
    bad(name_, std::to_string(text.size()) + " bytes that do not start with 'ply', expected a PLY file",
        "other formats that are read: .spz, .sog, .splat, .ksplat, .glb; else npx @playcanvas/splat-transform " +
            name_ + " model.ply");
  bool has_format = false;
  std::size_t properties = 0;
  for (std::size_t at = text.find('\n') + 1;;) {
    const std::size_t end = text.find('\n', at);
    if (end == std::string_view::npos)
      bad(name_, "the header stops after " + std::to_string(text.size()) + " bytes, expected 'end_header'");
    if (end > kMaxHeaderBytes)
      bad(name_, "no 'end_header' in the first " + std::to_string(kMaxHeaderBytes) + " bytes, expected a PLY header");
    std::string_view line = text.substr(at, end - at);
    if (line.ends_with('\r')) line.remove_suffix(1);
    at = end + 1;
    const std::vector<std::string_view> words = split(line);
    const std::string_view key = words.empty() ? std::string_view() : words[0];
    if (key == "end_header") {
      body_ = at;
      break;
    }
    if (key == "comment" || key == "obj_info") {
      const std::size_t content = line.find(key) + key.size() + 1;
      comments_.emplace_back(content < line.size() ? line.substr(content) : "");
    } else if (key == "format") {
      format_ = parse_format(name_, words);
      has_format = true;
    } else if (key == "element") {
      if (elements_.size() == kMaxElements)
        bad(name_, "more than " + std::to_string(kMaxElements) + " elements, expected at most that many");
      elements_.push_back(parse_element(name_, words));
    } else if (key == "property") {
      if (++properties > kMaxProperties)
        bad(name_, "more than " + std::to_string(kMaxProperties) + " properties, expected at most that many",
            "write models of many objects in parts: ngs-joint --object NAME");
      add_property(name_, elements_, parse_property(name_, words));
    } else if (!key.empty()) {
      bad(name_, "header line starting with '" + printable(key) + "', expected format, comment, element, property");
    }
  }
  if (!has_format) bad(name_, "the header has no format line, expected 'format binary_little_endian 1.0'");
  for (std::size_t i = 0; i < elements_.size(); ++i)
    if (find(elements_[i].name) != &elements_[i])
      bad(name_, "element '" + printable(elements_[i].name) + "' occurs twice, expected once");
}

PlyTable PlyFile::table(const PlyElement& element) const { return element_table({name_, format_, bytes_}, element); }

void PlyFile::locate_elements() {
  std::size_t at = body_;
  for (PlyElement& element : elements_) {
    element.begin = at;
    element.end = at = element_end({name_, format_, bytes_}, element);
  }
}

PlyWriter::PlyWriter(const std::string& path, const PlyElement& element, const std::vector<std::string>& comments)
    : file_(std::make_unique<AtomicFile>(path)), rows_left_(element.count) {
  std::string header =
      "ply\nformat binary_little_endian 1.0\nelement " + element.name + " " + std::to_string(element.count) + "\n";
  for (const PlyProperty& p : element.properties) {
    header += "property " + std::string(ply_type_name(p.type)) + " " + p.name + "\n";
    row_bytes_ += ply_type_bytes(p.type);
  }
  for (std::string comment : comments) {
    std::replace_if(
        comment.begin(), comment.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
    header += "comment " + comment + "\n";
  }
  header += "end_header\n";
  file_->write(header);
  buffer_.resize(std::max(kBufferBytes / std::max(row_bytes_, std::size_t(1)), std::size_t(1)) * row_bytes_);
}

PlyWriter::~PlyWriter() = default;

std::uint8_t* PlyWriter::row() {
  NGS_CHECK(rows_left_ > 0, "more rows than the header says");
  --rows_left_;
  if (used_ == buffer_.size()) flush();
  std::uint8_t* to = buffer_.data() + used_;
  used_ += row_bytes_;
  return to;
}

void PlyWriter::flush() {
  file_->write(buffer_.data(), used_);
  used_ = 0;
}

void PlyWriter::commit() {
  NGS_CHECK(rows_left_ == 0, std::to_string(rows_left_) + " rows fewer than the header says");
  flush();
  file_->commit();
}

}  // namespace ngs::io
