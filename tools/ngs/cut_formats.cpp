#include "cut_formats.h"

#include "ngs/core/error.h"
#include "ngs/io/formats/write_splat.h"

namespace ngs::ngs_tool {

void check_formats(const CutOptions& options) {
  for (const std::string& format : options.format)
    if (io::output_format("object." + format) == io::SplatFormat::kPly)
      throw Error(ErrorCode::kUsage, "--format " + format + ": unknown, expected one of " + io::kOutputFormats,
                  "such as --format sog; a PLY is always written");
}

void write_other_formats(cli::Run& run, const CutOptions& options, const std::string& folder) {
  if (options.format.empty()) return;
  std::optional<Vec3<double>> up;
  if (options.up != "auto") up = io::axis_named(options.up);
  for (const std::string half : {"object", "background"}) {
    const std::string path = folder + "/" + half + ".";
    const io::GaussianPly ply = io::read_gaussian_ply(path + "ply");
    for (const std::string& format : options.format)
      for (const std::string& note : io::write_splat(path + format, {ply, {}, nullptr, up})) run.monitor().warn(note);
  }
}

}  // namespace ngs::ngs_tool
