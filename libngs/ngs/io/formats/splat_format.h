#pragma once
// The file formats of Gaussian splatting models that are read or written (docs/formats.md), and their detection.
#include <cstdint>
#include <string>
#include <string_view>

#include "ngs/io/files/mapped_file.h"
#include "ngs/io/formats/splat_table.h"

namespace ngs::io {

enum class SplatFormat : std::uint8_t { kPly, kCompressedPly, kSpz, kSog, kSplat, kKsplat, kGlb, kUsda };

/// The names of the formats that are written, for help and errors.
inline constexpr const char* kOutputFormats = ".ply, .compressed.ply, .spz, .sog, .splat, .glb or .usda";

/// Format of an input: kPly (also for compressed.ply, which the PLY reader detects), kSpz, kSog, kSplat, kKsplat, kGlb,
/// or kUsda (write-only). Determined by the first bytes if the format has a signature, else by the extension of `name`.
/// kPly if neither matches, so that the PLY reader reports what it expected.
SplatFormat input_format(std::string_view name, Bytes bytes);

/// Format of an output, by its extension; kPly for every other name. kUsage for .ksplat, which is read-only, and
/// for the binary forms of .usda.
SplatFormat output_format(std::string_view path);

/// Whether the extension of this name is that of a readable format other than PLY.
bool is_model_name(std::string_view name);

/// Labels are columns of a plain PLY; the other formats cannot store them. kUsage if `path` has another format.
void require_ply_output(const std::string& path);

// One entry point for the readers of all formats but PLY.

/// `format` must not be PLY. Throws kBadInput.
DecodedSplat decode_splat(SplatFormat format, const std::string& name, Bytes bytes);

}  // namespace ngs::io
