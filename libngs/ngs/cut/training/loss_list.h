#pragma once
// The terms of the loss, in the order in which they are evaluated.
#include <memory>
#include <vector>

namespace ngs {

class LossTerm;
using Losses = std::vector<std::shared_ptr<LossTerm>>;

// Each is defined in the file of the term.
std::unique_ptr<LossTerm> make_photometric_loss();
std::unique_ptr<LossTerm> make_field_losses();
std::unique_ptr<LossTerm> make_mask_loss();
std::unique_ptr<LossTerm> make_continuity_loss();

Losses all_losses();

}  // namespace ngs
