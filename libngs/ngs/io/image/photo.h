#pragma once
// The photograph of a view at its camera's size.
#include <cstddef>

#include "ngs/io/image/image_file.h"
#include "ngs/scene/scene.h"

namespace ngs::io {

/// [H, W, 3] RGB in [0, 1], transparent pixels over the scene's background as trainers do, reduced by area averaging
/// where the file is larger than the camera by an integer factor or by the scene's image_scale; any other size is
/// kInconsistent. Empty image: the view has no photo.
ImageF load_photo(const Scene& scene, std::size_t view);

/// The same, as the samples of the file where it has the camera's size.
PackedPhoto read_packed_photo(const Scene& scene, std::size_t view);
/// What read_packed_photo() will take, from the file's header alone; 0 where the view has no photo.
double held_photo_bytes(const Scene& scene, std::size_t view);

/// The same with up to `most` times the camera's pixels per side, as far as the file has them.
ImageF load_fine_photo(const Scene& scene, std::size_t view, int most = 2);
/// The size of the view's photo, which the camera's over image_scale is but for rounding; that where there is no photo
/// or it is not the one that the scene was imported with.
ImageSize full_size(const Scene& scene, std::size_t view);

/// Whether the scene's background shows through the photo: then it is no photo of that background.
bool photo_is_transparent(const Scene& scene, std::size_t view);

}  // namespace ngs::io
