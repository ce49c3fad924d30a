#pragma once
// The options of ngs-scene import, which ngs cut has too if its input is a capture.
#include "ngs/core/error.h"
#include "ngs/io/scene/import_scene.h"
#include "ngs/options/field.h"
#include "ngs/render/render_options.h"

namespace ngs::cli {

inline constexpr NamedValue<MaskMode> kMaskModeNames[] = {
    {MaskMode::kBinary, "binary"}, {MaskMode::kLabel, "label"}, {MaskMode::kSoft, "soft"}, {MaskMode::kBands, "bands"}};
inline constexpr NamedValue<MissingMask> kMissingNames[] = {
    {MissingMask::kUnknown, "unknown"}, {MissingMask::kEmpty, "empty"}, {MissingMask::kError, "error"}};

struct ImportOptions {
  MaskMode mask_mode = MaskMode::kBinary;
  std::vector<std::string> object_id;
  bool mask_invert = false;
  double mask_threshold = kMaskThreshold;
  int void_id = -1;
  MissingMask missing_mask = MissingMask::kUnknown;
  bool masks_in_order = false;
  int mask_shift = 0;
  std::string hold_out;
  double image_scale = 0;
  double filter_px2 = 0;
  CompatChoice compat = CompatChoice::kAuto;
  Antialias antialias = Antialias::kAuto;
  std::string background;
  bool original_world = false;
  bool align_views = true;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.mask_mode,
          Choice<MaskMode>{"mask_mode", "How mask values are read (bands: <128 unknown, <=250 background)",
                           kMaskModeNames});
    visit(self.object_id,
          Text{"object_id", "N|NAME=N|NAME", "An object: its id in label maps, or the name of its folder of masks"});
    visit(self.mask_invert, Flag{"mask_invert", "Read black as object, white as background"});
    visit(self.mask_threshold,
          Field<double>{"mask_threshold", "", "Binary masks: object at and above this value (of 255)", 0.0, 255.0});
    visit(
        self.void_id,
        Field<int>{"void_id", "", "Label maps: id of pixels without a label, such as 255 in VOC; -1: none", -1, 65535});
    visit(self.missing_mask,
          Choice<MissingMask>{"missing_mask", "How a view without a mask is treated", kMissingNames});
    visit(self.masks_in_order,
          Flag{"masks_in_order", "Pair masks and views in the order of their names, if there are as many"});
    visit(self.mask_shift,
          Field<int>{"mask_shift", "names", "Give each view the mask that is this many names later than its own",
                     -1000000, 1000000});
    visit(self.hold_out,
          Text{"hold_out", "every:N:K|FILE",
               "Views that never supervise: index i of the sorted names with i % N == K, or a list of names"});
    visit(self.image_scale,
          Field<double>{"image_scale", "",
                        "Working size relative to the photos; 0: 1, 1/2, 1/3 ... so that no side exceeds 800 px", 0,
                        1.0});
    visit(
        self.filter_px2,
        Field<double>{
            "filter_px2", "px^2",
            "Low-pass filter that the model was fitted with, at the working size; 0: the one that fits the photos best",
            0, 1e4});
    visit(self.compat, Choice<CompatChoice>{"compat",
                                            "Renderer that the model was fitted with: its near plane and footprint "
                                            "rule; auto: inria, or gsplat if that fits the photos better",
                                            kCompatChoices});
    visit(self.antialias, Choice<Antialias>{"antialias",
                                            "Opacity compensation that the model was fitted with; auto: from the PLY's "
                                            "comments or its trainer's cfg_args",
                                            kAntialiasNames});
    visit(self.background,
          Text{"background", "COLOUR",
               "Colour behind the model: black, white or R,G,B in [0, 1]; empty: the one that fits the photos"});
    visit(self.align_views, Flag{"align_views", "Correct camera poses so that renders of the model match the photos"});
    visit(self.original_world, Flag{"original_world", "Undo the applied_transform of transforms.json"});
  }
};

/// Throws kUsage if options contradict each other, before any file is read.
inline void require_consistent(const ImportOptions& options) {
  const bool label_maps = options.mask_mode == MaskMode::kLabel;
  if (options.void_id >= 0 && !label_maps)
    throw Error(ErrorCode::kUsage,
                "--void-id " + std::to_string(options.void_id) + " without label maps, expected with them only",
                "add --mask-mode label, or leave --void-id out");
  if (options.mask_invert && label_maps)
    throw Error(ErrorCode::kUsage, "--mask-invert with label maps, expected with binary, soft or bands only",
                "leave --mask-invert out; the objects of label maps are named by --object-id");
}

/// The inputs of the command line; empty: not given.
struct ImportPaths {
  std::string ply, images, masks, truth, world_transform;
};

inline io::ImportRequest request_from(const ImportOptions& options, const std::string& source,
                                      const ImportPaths& paths) {
  require_consistent(options);
  io::ImportRequest request;
  request.capture = {source, paths.images, paths.world_transform, options.original_world};
  request.model_path = paths.ply;
  request.masks_dir = paths.masks;
  request.truth_dir = paths.truth;
  request.object_ids = options.object_id;
  request.hold_out = options.hold_out;
  request.mask_mode = options.mask_mode;
  request.mask_invert = options.mask_invert;
  request.mask_threshold = options.mask_threshold;
  request.missing_mask = options.missing_mask;
  request.masks_in_order = options.masks_in_order;
  request.mask_shift = options.mask_shift;
  request.image_scale = options.image_scale;
  if (options.void_id >= 0) request.void_id = std::uint32_t(options.void_id);
  return request;
}

}  // namespace ngs::cli
