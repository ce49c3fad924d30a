#pragma once
// --boundary field of ngs-render: the contours as the field of --nerf shows them.
#include <optional>
#include <string>

#include "ngs/stages/render/render_stage.h"
#include "render_output.h"
#include "shared/scene/field_file.h"
#include "shared/tool.h"

namespace ngs::picture {

/// The field of the file at `path`, where the options ask for it. kUsage where they do and there is none, kBadInput
/// where the model has no masks whose contours it could draw.
std::optional<FieldModel> boundary_field(cli::Run& run, const RenderOptions& options, const std::string& path,
                                         const Objects& objects);

/// Blends it into the view; the report counts the pixels that it draws (field_pixels).
void draw_boundary(cli::Run& run, FieldModel& field, const FieldBand& where, RenderedView& view);

}  // namespace ngs::picture
