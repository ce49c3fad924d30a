#pragma once
// Colour, alpha and optical depth of rays through the field.                              Eq. (1)
//
// Colours include the background, so they compare with a rendered view over the same background (C15). K = 0 samples:
// the background, alpha 0. Results do not depend on exec.threads.
#include <vector>

#include "ngs/backend/exec.h"
#include "ngs/ops/field/field_types.h"

namespace ngs {

void volume_forward(const Exec& exec, const VolumeInputs& in, VolumeOutput& out);

/// Overwrites `out`.
void volume_backward(const Exec& exec, const VolumeInputs& in, const VolumeOutput& forward,
                     const VolumeOutputGradients& grad, VolumeGradients& out);

}  // namespace ngs
