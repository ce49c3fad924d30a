#pragma once
// Reads mask files of any convention as targets in [0, 1] at the camera's size. Mask modes:
//
// clang-format off
//   binary  object where value >= threshold (8-bit scale; 16-bit and EXR values are scaled to it). A file whose largest
//           value is 1 is a {0, 1} mask: object where 1, with a note; likewise a 16-bit file with values 0 and 255. Three
//           values with the middle one (about half) between the others everywhere: a trimap, there unknown, with a note.
//   label   object k where value == its id, unknown where value == void_id; 8 or 16 bit, palette PNGs by index, EXR by
//           channel ngs.id, Y or R.
//   soft    value / full scale of the file; EXR in [0, 1] (channel ngs.mask, else A, Y, R, else the only channel).
//   bands   value < 128: unknown; 128..250: background; > 250: object (LichtFeld's ignore / segment / keep).
// clang-format on
//
// Colour files: three equal channels are read as grey. An RGBA file whose alpha is not constant is a cut-out: its alpha
// is the mask. Of other colours the largest channel is used (scene/mask_samples.h); in label mode they are rejected.
// `mask_invert` swaps object and background, never unknown.
//
// A file of another size is resampled if photo.h allows it, else kInconsistent. Reduction: soft by area average;
// binary, label and bands by majority of the covered area (a tie is object). Enlargement: nearest neighbour.
//
// A mask_path with "{object}" means one file per object (binary, soft or bands). A view has masks only if the files of
// all objects exist; with missing_mask kEmpty an absent file is an empty mask.
#include <cstddef>
#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "ngs/scene/scene.h"

namespace ngs::io {

struct LoadedMasks {
  ViewMasks masks;
  std::vector<std::string> notes;  // assumptions and resampling, each with the file name
  bool lossy = false;              // JPEG
  bool resized = false;
};

/// kBadInput: an unreadable file, or one that does not fit the mode. kInconsistent: wrong size, or no mask with
/// missing_mask kError.
LoadedMasks load_masks_with_notes(const Scene& scene, std::size_t view);
ViewMasks load_masks(const Scene& scene, std::size_t view);

/// By the file extension, ignoring case.
bool is_exr(const std::string& path);
/// The label map of an EXR, [H, W, 1]: channel ngs.id, else Y, else R, else the only one. kBadInput: no such channel,
/// or values that are no whole numbers in 0..65535.
ImageF read_id_exr(const std::string& path);

std::set<std::uint32_t> ids_in_label_map(const std::string& path);

/// A label map as stored, [H, W, 1] ids. kBadInput: an unreadable file, or no label map. kInconsistent: its size does
/// not fit the camera.
ImageU16 read_label_map(const std::string& path, const Camera& camera, double image_scale);

/// The mask files of a view: one, or one per object if the path contains "{object}". Empty: no mask.
std::vector<std::string> mask_files(const Scene& scene, std::size_t view);

}  // namespace ngs::io
