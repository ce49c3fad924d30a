#include "ngs/io/formats/decode_splat.h"

#include "ngs/core/check.h"
#include "ngs/core/error.h"
#include "ngs/io/formats/dot_splat.h"
#include "ngs/io/formats/gltf/glb_read.h"
#include "ngs/io/formats/ksplat.h"
#include "ngs/io/formats/sog.h"
#include "ngs/io/formats/spz.h"

namespace ngs::io {

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
