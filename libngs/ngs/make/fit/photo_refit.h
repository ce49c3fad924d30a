#pragma once
// A brief photometric refit of an existing model, for the colours of surfaces that an edit of its rows uncovered.
#include <functional>

#include "ngs/problem/problem.h"

namespace ngs {

/// Initial rates of 3DGS; the position's is per unit of the cameras' extent.
struct RefitOptions {
  int epochs = 10;  // of every view
  double position_lr = 1.6e-4, rotation_lr = 1e-3, scale_lr = 5e-3, opacity_lr = 5e-2, dc_lr = 2.5e-3,
         rest_lr = 1.25e-4;
  double decay = 0.1;  // final rate divided by initial rate, for all rates
};

/// Mean PSNR of the clamped render over `views`; 0 without views.
double mean_psnr_db(const Exec& exec, const Problem& input, const GaussianCloud& cloud,
                    const std::vector<std::size_t>& views);

struct RefitInputs {
  const Problem& problem;
  const std::vector<std::size_t>& views;                // indices of its scene's views, each with a photo
  const std::vector<std::uint8_t>& moves;               // [N] 1: geometry and opacity are trained as well
  const std::vector<std::uint8_t>& trained;             // [N] 0: the row stays unchanged
  std::function<ImageF(std::size_t view)> weight = {};  // [H, W, 1] of the loss, >= 0; empty function: 1 everywhere
};

/// Shuffles the views by the problem's seed, one step per view. Rows without weight in any view stay unchanged and are
/// left out of all renders.
void refit_to_photos(const Exec& exec, Monitor& monitor, const RefitOptions& options, const RefitInputs& in,
                     GaussianCloud& cloud);

}  // namespace ngs
