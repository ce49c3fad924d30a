#include "ngs/cut/training/loss_term.h"

namespace ngs {

void ImageGradients::begin(const RenderedView& rendered) {
  rendered_ = &rendered;
  taken_.clear();
}

ImageF& ImageGradients::overwritten(ImageF ViewGradients::*image) {
  NGS_CHECK(!is_taken(image), "a term overwrites the gradient of another term");
  taken_.push_back(image);
  const int channels = image == &ViewGradients::colour  ? rendered_->colour.channels
                       : image == &ViewGradients::label ? rendered_->label.channels
                                                        : 1;
  results_.shape(gradients_.*image, rendered_->width_px, rendered_->height_px, channels);
  return gradients_.*image;
}

ImageF& ImageGradients::added(ImageF ViewGradients::*image) {
  if (!is_taken(image)) fill_zero(exec_, overwritten(image).data);
  return gradients_.*image;
}

const ViewGradients& ImageGradients::end() {
  added(&ViewGradients::colour);
  for (const auto image : {&ViewGradients::label, &ViewGradients::alpha, &ViewGradients::depth})
    if (!is_taken(image)) results_.shape(gradients_.*image, 0, 0, 0);
  return gradients_;
}

}  // namespace ngs
