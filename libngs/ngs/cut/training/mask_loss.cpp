// L_mask: the rendered labels against the masks.                                                           Eq. (19)
#include "ngs/cut/training/loss_list.h"
#include "ngs/cut/training/loss_term.h"
#include "ngs/ops/losses/loss_mask.h"

namespace ngs {
namespace {

class MaskTerm final : public LossTerm {
 public:
  std::vector<Effect> effects() const override {
    return {{.name = "mask", .help = "use L_mask", .always = "the labels are trained by it"},
            {.name = "mask-geometry", .help = "let L_mask move the Gaussians", .always = "the gradients exist anyway"}};
  }
  void declare(OptionSet& options, const OptionGroup& group) override { options.add(*this, group); }
  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.weight_,
          Field<double>{"lambda_mask", "", "Weight of L_mask (Eq. 20)", 0, 1e6}.of("joint|contours,mask"));
  }
  std::unique_ptr<LossTerm> copy() const override { return std::make_unique<MaskTerm>(*this); }

  void add_on_view(LossStep& step) override {
    const ViewMasks& masks = step.given.masks;
    if (!masks.available) return;
    const auto timed = step.model.monitor.scope("mask loss");
    step.images.label_moves_geometry(step.model.options.on("mask-geometry"));
    ImageF& gradient = step.images.overwritten(&ViewGradients::label);
    const MaskLoss loss = loss_mask(step.model.exec, {MaskLossForm::kBce, 1.0},
                                    {&step.rendered.label, &masks, step.pixel_weight, step.shown}, weight_, &gradient);
    step.values.set("mask", weight_, loss.total);
  }

 private:
  double weight_ = 0.5;
};

}  // namespace

std::unique_ptr<LossTerm> make_mask_loss() { return std::make_unique<MaskTerm>(); }

}  // namespace ngs
