#include "ngs/cut/training/loss_list.h"

#include "ngs/cut/training/loss_term.h"

namespace ngs {

Losses all_losses() {
  Losses losses;
  losses.push_back(make_photometric_loss());
  losses.push_back(make_field_losses());
  losses.push_back(make_mask_loss());
  losses.push_back(make_continuity_loss());
  return losses;
}

}  // namespace ngs
