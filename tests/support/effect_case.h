#pragma once
// The joint case, with modifications that make the heuristics switch effects on.
#include <algorithm>
#include <memory>

#include "ngs/cut/evidence/variance_stage.h"
#include "ngs/cut/training/training_options.h"
#include "ngs/render/render_stage.h"
#include "support/joint_case.h"

namespace ngs::test {

struct EffectCase {
  std::unique_ptr<JointCase> base = joint_case();
  TrainingOptions training;
  int contour_epochs = 4;
  bool fine_photos = false;

  EffectCase() {
    training.joint = small_joint(12, 3, 48);
    training.sample.rows = training.sample.cols = 10;
    training.sample.depth_samples = 4;
    for (SceneView& v : base->scene.views) v.image_path = "photo";
  }
  Problem input() const {
    Problem in = base->input();
    if (fine_photos) in.load_fine_photo = in.load_photo;
    in.splat.antialiased = base->model.antialiased;
    return in;
  }
  void relabel(double tau = 0.2) {
    base->rule.tau = tau;
    base->labels = label_gaussians(
        base->rule,
        accumulate_evidence({}, Quiet(),
                            {base->model, base->scene, {0, 1, 2, 3}, base->input().splat, base->input().load_masks}));
  }
  void render_photos(const SplatOptions& splat = {}) {
    for (std::size_t v = 0; v < 4; ++v)
      base->photos[v] = render({}, base->model, base->scene.views[v].camera, splat, {}).colour;
  }
  void paint(float value) {  // one colour for all Gaussians, and photos rendered from them
    std::fill(base->model.sh_dc.begin(), base->model.sh_dc.end(), value);
    render_photos();
  }
};

/// Switches exposure on: one photo is darker.
inline void dark_photo(EffectCase& c) {
  for (float& x : c.base->photos[1].data) x *= 0.8f;
}

/// Switches mask-outliers on: one mask is shifted.
inline void shifted_mask(EffectCase& c) {
  std::vector<float>& mask = c.base->masks[1].target[0];
  std::rotate(mask.begin(), mask.begin() + 480 + 14, mask.end());
}

/// Switches floaters on: the first Gaussians of the wall are moved in front of the ball.
inline void floaters_in_front(EffectCase& c) {
  for (std::size_t i = 160; i < 166; ++i) {
    float* at = &c.base->model.position[3 * i];
    at[0] = 0.05f * float(i - 163);
    at[1] = 0;
    at[2] = 1.5f;
  }
}

}  // namespace ngs::test
