#include "boundary_field.h"

namespace ngs::picture {

std::optional<FieldModel> boundary_field(cli::Run& run, const RenderOptions& options, const std::string& path,
                                         const Objects& objects) {
  if (options.boundary == BoundarySource::kSplat) {
    run.warn_unused({"--nerf", "--boundary-band"}, "without --boundary field");
    return std::nullopt;
  }
  if (path.empty())
    throw Error(ErrorCode::kUsage, "--boundary field without --nerf, expected the file of the field",
                "ngs-joint ... --nerf FIELD writes one");
  if (objects.names.empty())
    throw Error(ErrorCode::kBadInput,
                "the model has no property ngs_label, expected a labelled PLY for --boundary field",
                "the field is drawn at the contours of its masks: take the labelled PLY of the same run");
  FieldModel field = cli::read_field(path);
  const int known = field.field.shape().objects;
  if (known != int(objects.names.size()))
    run.monitor().warn("--boundary field: " + path + " shows " + std::to_string(known) + " objects, the model has " +
                       std::to_string(objects.names.size()) +
                       ": masks stay the splat's; ngs-joint --field-masks trains a field that shows them");
  return field;
}

void draw_boundary(cli::Run& run, FieldModel& field, const FieldBand& where, RenderedView& view) {
  const auto timed = run.monitor().scope("field");
  const std::int64_t drawn = blend_field(run.exec(), field, where, view);
  run.result()["field_pixels"] = run.result().value("field_pixels", std::int64_t(0)) + drawn;
}

}  // namespace ngs::picture
