#pragma once
// The file formats of Gaussian splatting models that are read or written (data-schema/formats.md), and how a file's is
// recognised.
#include <cstdint>
#include <string>
#include <string_view>

#include "ngs/io/files/mapped_file.h"

namespace ngs::io {

enum class SplatFormat : std::uint8_t { kPly, kCompressedPly, kSpz, kSog, kSplat, kKsplat, kGlb };

/// Of an input: kPly (also for a compressed.ply, which the PLY reader tells), kSpz, kSog, kSplat, kKsplat, or kGlb,
/// which is written only. By its first bytes where the format has a signature, else by the extension of `name`; kPly
/// where neither says anything, so that the PLY reader explains what it expected.
SplatFormat input_format(std::string_view name, Bytes bytes);

/// Of an output: by its extension; kPly for every other name. kUsage for .ksplat, which is read only.
SplatFormat output_format(std::string_view path);

/// Whether a file of this name is a model in a format that is read, other than PLY, by its extension.
bool is_model_name(std::string_view name);

/// Labels are columns of a plain PLY; the other formats have no place for them. kUsage if `path` names one of those.
void require_ply_output(const std::string& path);

}  // namespace ngs::io
