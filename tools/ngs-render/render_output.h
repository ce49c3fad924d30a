#pragma once
// The output files of ngs-render.
// clang-format off
//   png, one layer                  DIR/STEM.png
//   png, several layers             DIR/<layer>/STEM.png
//   png, masks of several objects   .../<object>/STEM.png
//   exr                             DIR/STEM.exr with R G B A Z ngs.mask ngs.id (several objects: ngs.mask_<object>)
// clang-format on
// STEM includes folders if photos in several folders have the same name (scene/view_names.h).
#include <set>
#include <string>
#include <vector>

#include "ngs/io/ply/gaussian_ply.h"
#include "ngs/options/field.h"
#include "ngs/render/render_stage.h"

namespace ngs::picture {

enum class Format : std::uint8_t { kPng, kExr };
inline constexpr NamedValue<Format> kFormatNames[] = {{Format::kPng, "png"}, {Format::kExr, "exr"}};

enum class FileNames : std::uint8_t { kStem, kImage };
inline constexpr NamedValue<FileNames> kFileNames[] = {{FileNames::kStem, "stem"}, {FileNames::kImage, "image"}};

struct OutputOptions {
  Format format = Format::kPng;
  FileNames names = FileNames::kStem;
  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.format, Choice<Format>{"format", "Format; png: 8 bit (16 bit for depth and labels); exr: float layers",
                                      kFormatNames});
    visit(self.names,
          Choice<FileNames>{"names", "File names; stem: a.jpg -> a.png; image: a.jpg.png, as for COLMAP masks",
                            kFileNames});
  }
};

struct Objects {
  std::vector<std::string> names;
  std::vector<LabelColumns> columns;
  std::vector<std::uint16_t> ids;  // ids in label maps
  std::int64_t gaussians = 0;
};
/// The label sets of a model; none for a plain splat. Ids are those of the scene's label maps, else 1 2 3 ...
Objects objects_of(const io::GaussianPly& ply, const Scene& scene);

/// The layers, default {"mask"}. kUsage: an unknown name, a mask of a model without labels, an overlay in an EXR.
std::set<std::string> parse_layers(const std::vector<std::string>& layers, const Objects& objects, Format format);

struct Destination {
  std::string folder, stem;
};
/// [views] The STEM of each view's files (output_names); with kImage the full name of its photo, folders included.
std::vector<std::string> file_names(const Scene& scene, FileNames names);
/// The files that write_view() would write.
std::vector<std::string> files_of(const Destination& to, const Objects& objects, const std::set<std::string>& layers,
                                  Format format);

struct Wanted {
  const Objects& objects;
  const std::set<std::string>& layers;
  Format format;
  double threshold;  // pixels with a rendered label above it are object
};
void write_view(const Destination& to, const RenderedView& view, const Wanted& wanted);

}  // namespace ngs::picture
