// The photometric anchor: the rendered colours against the photo.                                               C16
#include "ngs/cut/training/loss_list.h"
#include "ngs/cut/training/loss_term.h"
#include "ngs/cut/training/scene_probe.h"
#include "ngs/ops/losses/photometric.h"

namespace ngs {
namespace {

class PhotometricTerm final : public LossTerm {
 public:
  std::vector<Effect> effects() const override {
    return {{.name = "photometric",
             .help = "anchor the colours to the photos",
             .saves = "compositing of colour, and SSIM",
             .heuristic = {"views that have a photo", 0, "one is enough",
                           [](SceneProbe& probe) { return probe.views_with_photo(); }}},
            {.name = "whole-photo",
             .help = "anchor to the whole photo; off: near the object",
             .saves = "SSIM away from the object",
             .needs = kJointEffect,
             .heuristic = {"share of the labels' weight outside the windows", 1e-3,
                           "a thousandth: masks move nothing there",
                           [](SceneProbe& probe) { return probe.label_sample().outside; }}}};
  }
  void declare(OptionSet& options, const OptionGroup& group) override { options.add(*this, group); }
  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.weight_, Field<double>{"photometric_weight", "", "Weight of 0.8 L1 + 0.2 DSSIM (C16)", 0, 1e6}.of(
                            "joint|contours,photometric"));
  }
  std::unique_ptr<LossTerm> copy() const override { return std::make_unique<PhotometricTerm>(*this); }

  void request(RenderRequest& request) const override { request.colour = true; }
  void add_on_view(LossStep& step) override {
    const ImageF& photo = step.given.photo;
    if (photo.empty()) return;
    const auto timed = step.model.monitor.scope("photometric");
    const PixelRect box = step.model.options.on("whole-photo") ? PixelRect{} : step.given.object;
    const double inside = box.empty() ? 1 : double(box.x1 - box.x0) * (box.y1 - box.y0) / double(photo.pixels());
    const double weight = step.tiles ? step.tiles->weight : 0;
    const double share = step.shown * (step.tiles ? weight / double(photo.pixels()) : inside);
    const ImageF* weights = step.tiles ? step.pixel_weight : nullptr;
    const PhotometricOptions anchor{.box = box, .gradient_scale = share * weight_, .weight_sum = weight};
    ImageF& gradient = step.images.overwritten(&ViewGradients::colour);
    const auto value = pass_.evaluate(step.model.exec, anchor, {step.rendered.colour, photo, weights}, &gradient);
    // Windows of SSIM reach into tiles that are not rendered.
    if (weights) keep_weighted(step.model.exec, *weights, nullptr, gradient);
    step.values.set("photometric", weight_, share * value.total);
  }

 private:
  double weight_ = 1;
  PhotometricPass<float> pass_;
};

}  // namespace

std::unique_ptr<LossTerm> make_photometric_loss() { return std::make_unique<PhotometricTerm>(); }

}  // namespace ngs
