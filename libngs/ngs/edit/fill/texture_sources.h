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

/// The texture of scene.surfaces[index]. Covered cells are known, with the object's shadows removed; cells of the hole
/// are unknown. A colour on only one side of the object may belong to another thing and is excluded: at least 3 of 8
/// sectors around the object must contain it (in proportion if fewer have known cells). Also sets shadows.contact.
TextureGrid texture_sources(const Exec& exec, const HoleScene& scene, std::size_t index, Shadows& shadows);

}  // namespace ngs
