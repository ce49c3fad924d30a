#pragma once
// The cells whose colours may continue into the hole: those of the surface itself.
#include "ngs/edit/fill/cast_shadow.h"
#include "ngs/edit/fill/contact_shadow.h"
#include "ngs/edit/fill/fill_texture.h"

namespace ngs {

/// The cells of a surface, and the object's shadows on them.
struct Shadows {
  HoleCells cells;
  CastShadow cast;
  ContactShadow contact;
};

/// sh_dc of a colour after its division by `factor` in (0, 1].
float relit(float sh_dc, double factor);

/// The texture of scene.surfaces[index]: covered cells are known, relit where the object's shadow was; the hole is
/// unknown. A colour found only on one side of the object, such as that of a thing which lies there, is no texture of
/// the surface: of eight sectors around the object, three must have it (fewer where fewer have known cells). Finds
/// shadows.contact, the dark ring around the object; the texture is relit there too.
TextureGrid texture_sources(const Exec& exec, const HoleScene& scene, std::size_t index, Shadows& shadows);

}  // namespace ngs
