#pragma once
// Mask files of any convention -> [0, 1] targets at the camera's size.
//
//   binary  object where value >= threshold (8-bit scale; 16-bit and EXR values are brought to it). A file
//           whose largest value is 1 is a {0,1} mask: object where 1 (with a note); so is a 16-bit file of 0 and 255.
//   label   object k where value == its id, unknown where it is void_id; 8 or 16 bit, palette PNGs by index, EXR by
//           channel ngs.id, Y or R.
//   soft    value / full scale of the file; EXR in [0, 1] (channel ngs.mask, else A, else Y, else R, else the
//           only one).
//   bands   value < 128: unknown; 128..250: background; > 250: object (LichtFeld's ignore / segment / keep).
//
// Colour files: equal channels count as grey; RGBA whose alpha is not constant is a cut-out, its alpha is the
// mask; other colours count by their largest channel (scene/mask_samples.h), as label maps they are refused.
// `mask_invert` swaps object and background, never the unknown.
//
// A file of another size is resampled where size_rule.h allows it, else kInconsistent. Reductions: soft by
// area; binary, label and bands by majority of the covered area (object wins a tie). Enlargements: nearest.
//
// A mask_path holding "{object}" stands for one file per object (binary, soft or bands). A view is available
// only if every object has its file; with missing_mask kEmpty an absent one is an empty mask.
#include <cstddef>
#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "ngs/scene/scene.h"

namespace ngs::io {

struct LoadedMasks {
  ViewMasks masks;
  std::vector<std::string> notes;  // what was assumed or resampled, each naming the file
  bool lossy = false;              // JPEG
  bool resized = false;
};

/// kBadInput: unreadable file or one that does not suit the mode. kInconsistent: wrong size, or no mask where
/// missing_mask is kError.
LoadedMasks load_masks_with_notes(const Scene& scene, std::size_t view);
ViewMasks load_masks(const Scene& scene, std::size_t view);

/// By the ending of its name, in any case.
bool is_exr(const std::string& path);
/// The label map of an EXR, [H, W, 1]: channel ngs.id, else Y, else R, else the only one. kBadInput: no such channel,
/// or values that are no whole numbers in 0..65535.
ImageF read_id_exr(const std::string& path);

/// Every value that occurs in a label map.
std::set<std::uint32_t> ids_in_label_map(const std::string& path);

/// The files of a view: one, or one per object where the path holds "{object}". Empty: no mask.
std::vector<std::string> mask_files(const Scene& scene, std::size_t view);

}  // namespace ngs::io
