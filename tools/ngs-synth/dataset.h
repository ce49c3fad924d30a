#pragma once
// The folder that ngs-synth writes: a capture, and its ground truth.
//
// clang-format off
//   images/NNNN.png sparse/0/{cameras,images,points3D}.txt   photos and poses
//   masks/NNNN.png     0/255, the target, with the requested errors       masks_gt/    the same, exact
//   labels/NNNN.png    16 bit ids, with the requested errors              labels_gt/   the same, exact
//   objects/NAME/NNNN.png  0/255, exact       layers/NNNN.exr  Z, ngs.id, ngs.mask (share of the pixel)
//   masks_everything/NNNN.png  16 bit ids that mean nothing across views, with the requested errors
//   halves/            with --truth halves
//   recipe.json        input of ngs-synth for the same scene          ground_truth.json  ids, names, errors
// clang-format on
#include <cstdint>
#include <string>
#include <vector>

#include "ngs/make/fit/fit_stage.h"
#include "ngs/make/synth/mask_noise.h"
#include "ngs/make/synth/synth_render.h"
#include "ngs/options/field.h"
#include "ngs/options/option_set.h"
#include "shared/run/run.h"

namespace ngs::cli {

struct SynthData {
  synth::Recipe recipe;
  synth::AnalyticScene scene;
  std::vector<Camera> cameras;
  std::vector<Camera> hole_cameras;  // synth::hole_rig(); empty: without halves/
  std::vector<synth::SynthView> views;
  std::vector<SparsePoint> points;
};

void build(SynthData& data, bool with_halves);

struct MaskErrors {
  std::vector<std::string> specs;  // as given
  synth::MaskNoise noise;
  std::uint64_t seed = 0;
  bool everything = false;  // also writes masks_everything/
};

/// FOLDER/NAME; creates the folder.
std::string in_folder(const std::string& folder, const std::string& name);
/// [H, W] 255 where the label is `id`, else 0.
ImageU8 binary_mask(const ImageU16& labels, std::uint32_t id);

void write_view(const Exec& exec, const std::string& folder, const SynthData& data, std::size_t view,
                const MaskErrors& errors);
void write_description(const std::string& folder, const SynthData& data, const MaskErrors& errors);

/// Loads a recipe by name, or from a JSON file of recipe options; sets `is_file` in the second case.
synth::Recipe load_recipe(const std::string& name_or_path, bool& is_file);
Json recipe_json(const synth::Recipe& recipe);

/// The photos as stored in the PNG files, and the points, for the fit.
std::vector<FitView> fit_views(const SynthData& data);
std::vector<FitPoint> fit_points(const std::vector<SparsePoint>& points);

// The options of ngs-synth that override its recipe.

/// kHalves: also the room without the target, and the target alone from all sides.
enum class Truth : std::uint8_t { kMasks, kHalves };

/// kEverything: also masks of all objects that are not associated across views.
enum class Masks : std::uint8_t { kObjects, kEverything };

struct SynthOptions {
  int view_count = 0, width_px = 0, height_px = 0, objects = 0;
  std::int64_t scene_seed = -1;
  std::string target;
  std::vector<std::string> mask_noise;
  bool grey = false, cast_shadows = false, fit = true;
  Truth truth = Truth::kMasks;
  Masks masks = Masks::kObjects;

  static constexpr NamedValue<Truth> kTruths[] = {{Truth::kMasks, "masks"}, {Truth::kHalves, "halves"}};
  static constexpr NamedValue<Masks> kMasks[] = {{Masks::kObjects, "objects"}, {Masks::kEverything, "everything"}};

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.view_count, Field<int>{"view_count", "", "Number of cameras; 0: from the recipe", 0, 10000});
    visit(self.width_px, Field<int>{"width_px", "px", "Image width; 0: from the recipe", 0, 16384});
    visit(self.height_px, Field<int>{"height_px", "px", "Image height; 0: from the recipe", 0, 16384});
    visit(self.scene_seed,
          Field<std::int64_t>{"scene_seed", "", "Seed of textures and layout; -1: from the recipe", -1, 1ll << 53});
    visit(self.objects, Field<int>{"objects", "", "Number of objects of messy; 0: from the recipe", 0, 10000});
    visit(self.target, Text{"target", "NAME", "Object whose masks go to masks/; default: from the recipe"});
    visit(self.mask_noise,
          Text{"mask_noise", "KIND:AMOUNT",
               "Errors to add to masks/ and labels/: erode:PX dilate:PX jitter:PX snap:PX drop:P swap:P blob:P; with "
               "--masks everything to masks_everything/ too, also merge:P split:P background:P"});
    visit(self.masks,
          Choice<Masks>{"masks",
                        "Masks to write; everything: also masks_everything/, masks of all objects whose ids "
                        "differ between the views",
                        kMasks});
    visit(self.grey, Flag{"grey", "Make all images grey; off: from the recipe"});
    visit(self.cast_shadows, Flag{"cast_shadows", "Let the objects cast shadows; off: from the recipe"});
    visit(self.truth, Choice<Truth>{"truth",
                                    "Ground truth to write; halves: also the room without the target, and the target "
                                    "alone from all sides, to halves/",
                                    kTruths});
    visit(self.fit, Flag{"fit", "Fit a splat to the photos and write point_cloud.ply"});
  }
};

// The folder halves/ of ngs-synth: the truth of a cut.
//
// clang-format off
//   background/scene.json  the room without the target: cameras of the scene (split train) and 24 more (held-out)
//   background/images/NAME.png                  photos
//   background/masks/NAME.png                   0/255, the hole: pixels where the full scene shows the target
//   background/depth/NAME.exr                   Z: camera z of the room without the target
//   object/scene.json      the target alone, from 64 directions all round
//   object/images/NNNN.png                      RGBA; alpha: share of the pixel that the target covers
//   object/masks/NAME.png                       at the cameras of the photos: 255 the target, 128 hidden parts of it
// clang-format on

/// Number of views that write_halves() renders; 0 without hole cameras.
std::size_t views_of_halves(const SynthData& data);

/// Writes both halves into `folder`. Returns early after a stop request.
void write_halves(Run& run, const std::string& folder, const SynthData& data);

// The splat that ngs-synth fits to its photos.

FitOptions small_fit();
/// Other defaults for a messy room, which has more surfaces than 8000 Gaussians can show.
void make_finer(FitOptions& options, const synth::Recipe& recipe);
/// Fits a splat and writes it to `path`, unless a stop is requested before.
void fit_splat(Run& run, const SynthData& data, const FitOptions& options, const std::string& path);

}  // namespace ngs::cli
