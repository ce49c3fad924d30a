#pragma once
// The photo of a view at its camera's size.
#include <cstddef>

#include "ngs/io/image/image_file.h"
#include "ngs/scene/scene.h"

namespace ngs::io {

/// [H, W, 3] RGB in [0, 1]. Transparent pixels are composited over the scene's background, as trainers do. A file
/// larger than the camera by an integer factor or by the scene's image_scale is reduced by area average; any other size
/// is kInconsistent. Empty image: the view has no photo.
ImageF load_photo(const Scene& scene, std::size_t view);

/// The same, as the file's samples if the file has the camera's size.
PackedPhoto read_packed_photo(const Scene& scene, std::size_t view);
/// Memory [bytes] that read_packed_photo() will need, from the file's header alone; 0 if the view has no photo.
double packed_photo_bytes(const Scene& scene, std::size_t view);

/// The same with up to `max_factor` times the camera's pixels per side, if the file has that many.
ImageF load_fine_photo(const Scene& scene, std::size_t view, int max_factor = 2);
/// The size of the view's photo, which is the camera's size / image_scale up to rounding. That quotient is returned if
/// there is no photo or it is not the one with which the scene was imported.
ImageSize full_size(const Scene& scene, std::size_t view);

/// Whether the photo is transparent somewhere, so that the scene's background is visible in it.
bool photo_is_transparent(const Scene& scene, std::size_t view);

/// Whether the view's mask is the alpha channel of its photo, which is then loaded without it.
bool has_mask_in_photo(const SceneView& view);
/// [H, W, 1] alpha of the photo in [0, 1], at the camera's size; empty: no photo, or it has no alpha.
ImageF load_alpha(const SceneView& view);

}  // namespace ngs::io
