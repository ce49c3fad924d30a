#pragma once
// A brief photometric refit of an existing model: what an edit of its rows uncovered gets its colours back.
#include "ngs/problem/problem.h"

namespace ngs {

/// 3DGS's first rates; the position's is per unit of the cameras' extent.
struct RefitOptions {
  int epochs = 10;  // of every view
  double position_lr = 1.6e-4, rotation_lr = 1e-3, scale_lr = 5e-3, opacity_lr = 5e-2, dc_lr = 2.5e-3,
         rest_lr = 1.25e-4;
  double decay = 0.1;  // all rates fall to this factor
};

/// Mean PSNR of the clamped render over `views`; 0 without any.
double mean_psnr_db(const Exec& exec, const Problem& input, const GaussianCloud& cloud,
                    const std::vector<std::size_t>& views);

struct RefitInputs {
  const Problem& problem;
  const std::vector<std::size_t>& views;     // of its scene, each with a photo
  const std::vector<std::uint8_t>& moves;    // [N] 1: geometry and opacity are trained as well
  const std::vector<std::uint8_t>& trained;  // [N] 0: the row stays as it is
};

/// Steps over the views in an order that depends on the problem's seed. Rows that no pixel of a view shows stay as they
/// are, and cost nothing.
void refit_to_photos(const Exec& exec, Monitor& monitor, const RefitOptions& options, const RefitInputs& in,
                     GaussianCloud& cloud);

}  // namespace ngs
