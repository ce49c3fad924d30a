#pragma once
// The field of ngs-joint in a file: what --nerf writes and ngs-render reads (safetensors, schema ngs.nerf.1).
#include <string>

#include "ngs/passes/joint/field_picture.h"

namespace ngs::cli {

/// `field` may be null: then nothing but the schema is written, and reading it back is kNothingFound.
void write_field(const std::string& path, const JointField* field, const BoundarySet& boundary,
                 const SampleOptions& sample);

/// kBadInput for whatever a run does not write: sizes that no option allows, arrays of another length, numbers that are
/// not finite.
FieldModel read_field(const std::string& path);

}  // namespace ngs::cli
