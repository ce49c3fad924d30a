#include "ngs/io/formats/splat_format.h"

#include <algorithm>
#include <cstring>

#include "ngs/core/check.h"
#include "ngs/core/error.h"
#include "ngs/io/formats/splat_codecs.h"

namespace ngs::io {
namespace {

bool begins_with(Bytes bytes, std::string_view signature) {
  return bytes.size() >= signature.size() && std::memcmp(bytes.data(), signature.data(), signature.size()) == 0;
}

bool ends_with(std::string_view name, std::string_view extension) {
  if (name.size() < extension.size()) return false;
  return std::equal(extension.begin(), extension.end(), name.end() - std::ptrdiff_t(extension.size()),
                    [](char wanted, char c) { return wanted == (c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c); });
}

}  // namespace

SplatFormat input_format(std::string_view name, Bytes bytes) {
  if (begins_with(bytes, "ply\n") || begins_with(bytes, "ply\r")) return SplatFormat::kPly;
  if (begins_with(bytes, "NGSP")) return SplatFormat::kSpz;
  if (begins_with(bytes, "PK\x03\x04")) return SplatFormat::kSog;
  if (begins_with(bytes, "glTF")) return SplatFormat::kGlb;
  if (begins_with(bytes, "#usda ")) return SplatFormat::kUsda;
  // .splat has no signature: its first record may even begin like a gzip stream, so its extension is checked first.
  if (ends_with(name, ".splat")) return SplatFormat::kSplat;
  if (ends_with(name, ".ksplat")) return SplatFormat::kKsplat;
  if (begins_with(bytes, "\x1f\x8b") || ends_with(name, ".spz")) return SplatFormat::kSpz;
  if (ends_with(name, ".sog")) return SplatFormat::kSog;
  return SplatFormat::kPly;
}

SplatFormat output_format(std::string_view path) {
  for (const std::string_view name : {".ksplat", ".usd", ".usdc", ".usdz"})
    if (ends_with(path, name))
      throw Error(ErrorCode::kUsage,
                  std::string(path) + ": a " + std::string(name) + ", which is " +
                      (name == ".ksplat" ? "read but " : "") + "not written, expected " + kOutputFormats,
                  "choose another name for the output");
  if (ends_with(path, ".compressed.ply")) return SplatFormat::kCompressedPly;
  if (ends_with(path, ".glb")) return SplatFormat::kGlb;
  if (ends_with(path, ".usda")) return SplatFormat::kUsda;
  if (ends_with(path, ".spz")) return SplatFormat::kSpz;
  if (ends_with(path, ".sog")) return SplatFormat::kSog;
  if (ends_with(path, ".splat")) return SplatFormat::kSplat;
  return SplatFormat::kPly;
}

bool is_model_name(std::string_view name) {
  return ends_with(name, ".spz") || ends_with(name, ".sog") || ends_with(name, ".splat") ||
         ends_with(name, ".ksplat") || ends_with(name, ".glb");
}

void require_ply_output(const std::string& path) {
  if (output_format(path) == SplatFormat::kPly) return;
  throw Error(ErrorCode::kUsage,
              path + ": a format without labels, expected a name that ends in .ply (and not in .compressed.ply)",
              "write the labelled model as PLY; ngs-extract writes object and background in other formats");
}

DecodedSplat decode_splat(SplatFormat format, const std::string& name, Bytes bytes) {
  switch (format) {
    case SplatFormat::kSpz: return decode_spz(name, bytes);
    case SplatFormat::kSog: return decode_sog(name, bytes);
    case SplatFormat::kSplat: return decode_dot_splat(name, bytes);
    case SplatFormat::kKsplat: return decode_ksplat(name, bytes);
    case SplatFormat::kGlb: return decode_glb(name, bytes);
    case SplatFormat::kUsda:
      throw Error(ErrorCode::kBadInput,
                  name + ": .usda can be written but not read, expected .ply, .spz, .sog, .splat, .ksplat or .glb",
                  "give the splat that it was written from, or export it in one of these formats");
    case SplatFormat::kPly:
    case SplatFormat::kCompressedPly: break;
  }
  NGS_CHECK(false, "PLY has a reader of its own");
  return {};
}

}  // namespace ngs::io
