#include <algorithm>
#include <map>

#include "commands.h"
#include "ngs/io/files/folder_index.h"
#include "ngs/io/image/image_file.h"
#include "ngs/make/synth/mask_noise.h"
#include "ngs/options/field.h"
#include "ngs/scene/view_names.h"
#include "shared/tool.h"

namespace ngs::scene_tool {
namespace {

struct DegradeOptions {
  std::vector<std::string> mask_noise;
  double missing = 0, wrong = 0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.mask_noise, Text{"mask_noise", "KIND:AMOUNT",
                                "Errors in every mask: erode:PX dilate:PX jitter:PX snap:PX drop:P blob:P"});
    visit(self.missing, Field<double>{"missing", "of the views", "Fraction of masks left out", 0, 1});
    visit(self.wrong,
          Field<double>{"wrong", "of the views", "Fraction of masks replaced by that of another view", 0, 1});
  }
};

ImageU16 read_binary(const std::string& path) {
  const io::RawMask raw = io::read_mask_raw(path, io::Palette::kMask);
  ImageU16 mask(raw.width_px, raw.height_px, 1);
  std::ranges::copy(object_pixels(raw.samples()), mask.data.begin());
  return mask;
}

/// Output masks are named by the stem of the input.
void require_unique_stems(const std::string& folder, const std::vector<std::string>& names) {
  std::map<std::string, std::string> seen;
  for (const std::string& name : names)
    if (const auto [other, is_first] = seen.emplace(image_stem(name), name); !is_first)
      throw Error(
          ErrorCode::kInconsistent,
          folder + ": '" + other->second + "' and '" + name + "' have the same stem, expected one file per view",
          "move one of them out of the folder");
}

/// The photo with the mask's stem, at the mask's size; contours snap to its edges.
ImageF photo_of(const io::FolderIndex& photos, const std::string& mask_name, const ImageU16& mask) {
  const std::string path = photos.find_stem(mask_name);
  if (path.empty())
    throw Error(ErrorCode::kBadInput,
                photos.folder() + ": not exactly one image named " + image_stem(mask_name) +
                    ", expected the photo of mask " + mask_name,
                "give the folder of the photos: --photos images");
  return io::resize_area(io::read_image_rgb(path), mask.width_px, mask.height_px);
}

void write_binary(const std::string& path, const ImageU16& mask) {
  ImageU8 image(mask.width_px, mask.height_px, 1);
  for (std::size_t p = 0; p < mask.data.size(); ++p) image.data[p] = mask.data[p] ? 255 : 0;
  io::write_png(path, image);
}

}  // namespace

int degrade_command(int argc, char** argv) {
  cli::Tool tool("ngs-scene degrade", "Add errors of known size to masks, to test the robustness of methods.",
                 {"ngs-scene degrade masks_gt --mask-noise dilate:3,jitter:2 -o masks_bad",
                  "ngs-scene degrade masks_gt --missing 0.2 --wrong 0.1 --seed 3 -o masks_bad",
                  "ngs-scene degrade masks_gt --photos images --mask-noise snap:4 -o masks_bad"});
  DegradeOptions options;
  tool.options(options);
  const cli::Input& masks = tool.input("masks", "folder of masks, 0/255 by view");
  const cli::Input& photos = tool.optional_input("--photos", "folder of the photos, for snap");
  const cli::Output& out = tool.output_dir("-o,--output", "folder for the degraded masks");

  return tool.run(argc, argv, [&](cli::Run& run) {
    const synth::MaskNoise noise = synth::parse_mask_noise(options.mask_noise, synth::NoiseOf::kOneObject);
    if (noise.snap_px > 0 && !photos)
      throw Error(ErrorCode::kUsage, "--mask-noise snap without photos, expected --photos",
                  "contours snap to the photos' edges: --photos images");
    const io::FolderIndex photo_index(photos.path);
    const std::vector<std::string> names = io::list_images(masks.path);
    if (names.empty()) {
      run.nothing_found(masks.path + ": no image in this folder", "give the folder of the masks");
      return cli::kDone;
    }
    require_unique_stems(masks.path, names);
    const std::vector<int> assigned =
        synth::mask_assignment(int(names.size()), options.missing, options.wrong, run.seed());
    Json missing = Json::array(), wrong = Json::object();
    for (std::size_t v = 0; v < names.size(); ++v) {
      if (assigned[v] < 0) missing.push_back(names[v]);
      if (assigned[v] >= 0 && assigned[v] != int(v)) wrong[names[v]] = names[std::size_t(assigned[v])];
    }
    run.result() = {{"masks", names.size()}, {"missing", missing}, {"wrong", wrong}};
    if (run.dry_run()) {
      run.plan({{"masks", names.size() - missing.size()}});
      return cli::kDone;
    }
    bool any_object = false;
    for (std::size_t v = 0; v < names.size(); ++v) {
      if (assigned[v] < 0) continue;
      const std::string& name = names[std::size_t(assigned[v])];
      const ImageU16 mask = read_binary(masks.path + "/" + name);
      const ImageF photo = noise.snap_px > 0 ? photo_of(photo_index, name, mask) : ImageF();
      write_binary(out.path + "/" + image_stem(names[v]) + ".png",
                   synth::disturb_labels(run.exec(), mask, noise, {1, int(v), run.seed(), &photo}));
      any_object |= std::ranges::find(mask.data, std::uint16_t(1)) != mask.data.end();
    }
    if (!any_object && missing.size() < names.size())
      run.monitor().warn(masks.path + ": no mask contains an object; expected values 0/255 or 0/1, not a label map");
    return cli::kDone;
  });
}

}  // namespace ngs::scene_tool
