#pragma once
// L_align: the rendered view and the field must agree on the boundary.                 Eq. (16); C15, C17
//
// Colour and opacity are compared at the nodes of the view's grid; the variance term reduces the rendered colour
// variance in the 7x7 patches around them. Nodes can be switched off (rays_on_surface). No active node: loss 0. Results
// do not depend on exec.threads.
#include <vector>

#include "ngs/backend/exec.h"
#include "ngs/math/pixel_grid.h"
#include "ngs/scene/views.h"

namespace ngs {

struct AlignOptions {
  double weight_alpha = 0.5;      // w_α
  double weight_variance = 0.01;  // w_v
};

struct AlignInputs {
  PixelGrid grid;
  const ImageF* colour = nullptr;                     // [H, W, 3] rendered
  const ImageF* alpha = nullptr;                      // [H, W, 1] rendered
  const std::vector<float>* field_colour = nullptr;   // [R, 3] VolumeOutput::colour
  const std::vector<float>* field_alpha = nullptr;    // [R]
  const std::vector<std::uint8_t>* active = nullptr;  // [R]; null: every node
};

/// `total` = colour + w_α alpha + w_v variance; each a mean over the active nodes.
struct AlignLoss {
  double total = 0, colour = 0, alpha = 0, variance = 0;
  std::int64_t nodes = 0;
};

/// Results of the forward pass that the backward pass needs.
struct AlignContext {
  std::int64_t nodes = 0;  // active ones
  std::vector<float> colour_residual, alpha_residual, patch_mean, patch_share;
};

AlignLoss loss_align(const Exec& exec, const AlignOptions& options, const AlignInputs& in, AlignContext& context);

struct AlignFieldGradients {
  std::vector<float> colour, alpha;  // [R, 3], [R]
};

/// Receives `weight` · ∂total.
struct AlignGradients {
  double weight;
  AlignFieldGradients& field;                    // overwritten
  ImageF &colour_accumulate, &alpha_accumulate;  // of the rendered images, and shaped like them
};

void loss_align_backward(const Exec& exec, const AlignOptions& options, const AlignInputs& in, AlignContext& context,
                         const AlignGradients& out);

}  // namespace ngs
