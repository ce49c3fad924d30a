#include "ngs/io/formats/compression/packed_model.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "ngs/core/error.h"
#include "ngs/core/listed.h"
#include "ngs/io/files/shell_word.h"
#include "ngs/io/formats/compression/gzip.h"
#include "ngs/io/formats/compression/zip_archive.h"
#include "ngs/io/ply/ply_scan.h"

namespace ngs::io {
namespace {

constexpr std::size_t kMaxPlyExpansion = 64;  // columns of zeros compress a model up to 15 times

std::string_view text_of(Bytes bytes) { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }

bool has_entry(const std::vector<std::string>& entries, std::string_view file) {
  return std::ranges::any_of(
      entries, [&](const std::string& entry) { return entry == file || entry.ends_with("/" + std::string(file)); });
}

std::string names_of(std::vector<std::string> entries) {
  for (std::string& entry : entries) entry = printable(entry);
  return listed(entries, 4);
}

bool is_ply_name(std::string name) {
  std::ranges::transform(name, name.begin(), [](char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; });
  return name.ends_with(".ply") && !name.starts_with("__macosx/");
}

std::optional<PackedPly> gunzip_ply(const std::string& name, Bytes bytes) {
  {
    constexpr std::size_t kHeadBytes = 16;  // those of an .spz
    std::vector<std::uint8_t> head(kHeadBytes);
    GunzipReader reader(name, bytes);
    reader.read(head);
    if (!begins_like_ply(head)) return std::nullopt;
  }
  GunzipReader reader(name, bytes);
  return PackedPly{reader.read_all(bytes.size() * kMaxPlyExpansion), "the gzip stream holds a PLY, which is read"};
}

std::optional<PackedPly> unzip_ply(const std::string& name, Bytes bytes) {
  const ZipReader archive(name, bytes);
  const std::vector<std::string> entries = archive.names();
  if (has_entry(entries, "lod-meta.json")) refuse_unpacked_sog(name, "an archive of a streamed .sog");
  if (has_entry(entries, "meta.json")) return std::nullopt;
  if (has_entry(entries, "data.pkl"))
    throw Error(ErrorCode::kBadInput, name + ": a PyTorch checkpoint, expected a model",
                "export the splat as PLY with the program that trained it");
  std::vector<std::string> plys;
  std::ranges::copy_if(entries, std::back_inserter(plys), is_ply_name);
  if (plys.size() != 1)
    throw Error(ErrorCode::kBadInput,
                name + ": a zip archive of " + (entries.empty() ? "nothing" : names_of(plys.empty() ? entries : plys)) +
                    ", expected a .sog (meta.json and pictures) or one PLY in it",
                "unzip it, and name the model in it");
  const bool is_capture = std::ranges::any_of(entries, [](const std::string& entry) {
    return entry.ends_with("images.bin") || entry.ends_with("images.txt") || entry.ends_with("transforms.json");
  });
  return PackedPly{archive.read(plys[0], bytes.size() * kMaxPlyExpansion),
                   "the zip archive holds " + printable(plys[0]) + ", which is read" +
                       (is_capture ? ", not its photos and cameras: unpack it to use them" : "")};
}

struct KnownFile {
  std::string_view signature, what, remedy;
};
constexpr const char* kUnpack = "unpack it, and name the model in it";
constexpr const char* kExport = "export the model as PLY";
constexpr KnownFile kKnownFiles[] = {
    {"version https://git-lfs", "a Git LFS pointer, without the data", "fetch the file itself: git lfs pull"},
    {"<!DOCTYPE", "a web page", "download the model itself, not the page that shows it"},
    {"<!doctype", "a web page", "download the model itself, not the page that shows it"},
    {"<html", "a web page", "download the model itself, not the page that shows it"},
    {"7z\xbc\xaf\x27\x1c", "a 7z archive", kUnpack},
    {"Rar!", "a rar archive", kUnpack},
    {"BZh", "a bzip2 stream", kUnpack},
    {"\xfd"
     "7zXZ",
     "an xz stream", kUnpack},
    {"\x28\xb5\x2f\xfd", "a zstd stream", kUnpack},
    {"LASF", "a LAS point cloud, not a splat", "ngs-fit makes a splat from posed photos"},
    {"ASTM-E57", "an E57 point cloud, not a splat", "ngs-fit makes a splat from posed photos"},
    {"\x80\x02", "a Python pickle", kExport},
};

}  // namespace

bool begins_like_ply(Bytes bytes) { return text_of(bytes).starts_with("ply\n") || text_of(bytes).starts_with("ply\r"); }

std::string_view sog_kind(const nlohmann::json& root) {
  if (!root.is_object()) return "";
  if (root.contains("means") && root.contains("quats") && root.contains("sh0")) return "an unpacked .sog";
  return root.contains("lodLevels") || (root.contains("filenames") && root.contains("tree")) ? "a streamed .sog" : "";
}

void refuse_unpacked_sog(const std::string& name, std::string_view kind) {
  throw Error(ErrorCode::kBadInput, name + ": " + std::string(kind) + ", expected a .sog in one file",
              "npx @playcanvas/splat-transform " + shell_word(name) + " model.ply");
}

std::optional<PackedPly> unpack_ply(const std::string& name, Bytes bytes) {
  if (text_of(bytes).starts_with("\x1f\x8b")) return gunzip_ply(name, bytes);
  if (text_of(bytes).starts_with("PK\x03\x04")) return unzip_ply(name, bytes);
  return std::nullopt;
}

void refuse_known_file(const std::string& name, Bytes bytes) {
  constexpr std::size_t kMaxJsonBytes = std::size_t(64) << 20;
  const std::string_view text = text_of(bytes);
  for (const KnownFile& known : kKnownFiles)
    if (text.starts_with(known.signature))
      throw Error(ErrorCode::kBadInput, name + ": " + std::string(known.what) + ", expected a model",
                  std::string(known.remedy));
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos || text[first] != '{' || bytes.size() > kMaxJsonBytes) return;
  const nlohmann::json root = nlohmann::json::parse(text, nullptr, false);
  if (const std::string_view kind = sog_kind(root); !kind.empty()) refuse_unpacked_sog(name, kind);
}

}  // namespace ngs::io
