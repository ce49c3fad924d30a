#include "ngs/io/formats/write_splat.h"

#include "ngs/core/check.h"
#include "ngs/core/error.h"
#include "ngs/io/files/atomic_file.h"
#include "ngs/io/formats/compressed_ply_write.h"
#include "ngs/io/formats/dot_splat.h"
#include "ngs/io/formats/glb_write.h"
#include "ngs/io/formats/sog.h"
#include "ngs/io/formats/splat_format.h"
#include "ngs/io/formats/spz.h"

namespace ngs::io {
namespace {

std::vector<std::uint8_t> encode(SplatFormat format, const SplatSelection& model) {
  switch (format) {
    case SplatFormat::kSpz: return encode_spz(model);
    case SplatFormat::kSog: return encode_sog(model);
    case SplatFormat::kSplat: return encode_dot_splat(model);
    case SplatFormat::kCompressedPly: return encode_compressed_ply(model);
    case SplatFormat::kGlb: return encode_glb(model);
    case SplatFormat::kKsplat:
    case SplatFormat::kPly: break;
  }
  NGS_CHECK(false, "a format that is written here");
  return {};
}

std::vector<std::string> write_encoded(const std::string& path, const SplatSelection& model) {
  const std::vector<std::uint8_t> bytes = with_context(path, [&] { return encode(output_format(path), model); });
  write_file(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  if (model.left_out == 0) return {};
  return {path + ": " + std::to_string(model.left_out) +
          " Gaussians have values that are not finite or absurd and are left out; a PLY keeps them"};
}

}  // namespace

std::vector<std::string> write_splat(const std::string& path, const GaussianCloud& cloud,
                                     const std::vector<std::uint8_t>& keep, const std::vector<std::string>& comments) {
  if (output_format(path) != SplatFormat::kPly) return write_encoded(path, select_rows(cloud, keep));
  write_strict_ply(path, cloud, keep, comments);
  return {};
}

std::vector<std::string> write_splat(const std::string& path, const GaussianPly& model,
                                     const std::vector<std::uint8_t>& keep) {
  if (output_format(path) != SplatFormat::kPly) return write_encoded(path, select_rows(model.cloud, keep));
  write_strict_ply(path, model, keep);
  return {};
}

}  // namespace ngs::io
