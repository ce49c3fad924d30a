#pragma once
// Fails if the masks of a scene do not fit its views, with the cause and the command that mends it.
#include "ngs/capture/mask_agreement.h"
#include "shared/run/run.h"

namespace ngs::variance {

/// Reports capture/mask_agreement.h. Throws kInconsistent unless the verdict is kFit.
void check_masks(cli::Run& run, const MaskAgreementOptions& options, const EvidenceInputs& in);

}  // namespace ngs::variance
