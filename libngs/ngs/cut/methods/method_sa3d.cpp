#include "ngs/cut/methods/method_sa3d.h"

#include "ngs/cut/evidence/method_labels.h"
#include "ngs/ops/image/mask_pair.h"

namespace ngs {
namespace {

struct ObjectState {
  int object;
  BoundaryRule rule;
  GaussianCloud cloud;                // `usable` is 0 for Gaussians that a pass removed
  Evidence evidence;                  // of the current pass
  std::vector<std::size_t> accepted;  // views that passed the gate in the first pass
  std::vector<float> label() const {
    std::vector<float> out(std::size_t(evidence.gaussians), 0.f);
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = float(is_object(rule, evidence.prob(i, 0)));
    return out;
  }
};

/// IoU of the rendered label mask and the given mask over known pixels; 1 if both are empty.
double mask_agreement(const Exec& exec, const ObjectState& state, const Problem& input, const Camera& camera,
                      const ViewMasks& masks) {
  const std::vector<float> label = state.label();
  RenderRequest request{.colour = false, .label = {label.data(), std::int64_t(label.size()), 1}};
  const RenderedView view = render(exec, state.cloud, camera, input.splat, request);
  return iou(MaskPair(view.label, masks, 0, foreground_boxes(view.label)[0]).counts(exec));
}

/// The view's mask of this object only, so that no evidence of other objects is accumulated.
ViewMasks masks_of(const Problem& input, std::size_t view, const ObjectState& state) {
  ViewMasks masks = input.load_masks(view);
  if (masks.available) masks.target = {std::move(masks.target[std::size_t(state.object)])};
  return masks;
}

void add_view(const Exec& exec, const Problem& input, std::size_t view, const ViewMasks& masks, ObjectState& state) {
  add_view_evidence(exec, state.cloud, {input.scene.views[view].camera, masks}, input.splat, state.evidence);
}

void first_pass(const Exec& exec, Monitor& monitor, const Sa3dOptions& options, const Problem& input,
                ObjectState& state) {
  for (const std::size_t view : input.views) {
    if (monitor.stop_requested()) return;
    const ViewMasks masks = masks_of(input, view, state);
    if (!masks.available) continue;
    const Camera& camera = input.scene.views[view].camera;
    if (!state.accepted.empty() && mask_agreement(exec, state, input, camera, masks) < options.gate_iou) continue;
    state.accepted.push_back(view);
    add_view(exec, input, view, masks, state);
  }
}

void later_pass(const Exec& exec, const Problem& input, ObjectState& state) {
  const std::vector<float> label = state.label();
  for (std::size_t i = 0; i < label.size(); ++i) state.cloud.usable[i] &= label[i] > 0.f;
  state.evidence = Evidence(state.cloud.size(), 1);
  for (const std::size_t view : state.accepted) add_view(exec, input, view, masks_of(input, view, state), state);
}

}  // namespace

Solution run_sa3d(const Exec& exec, Monitor& monitor, const Sa3dOptions& options, const Problem& input) {
  const auto timed = monitor.scope("sa3d");
  Solution result;
  result.cloud = unchanged(input.cloud);
  const double threshold = options.lambda / (1 + options.lambda);
  for (int k = 0; k < int(input.scene.objects.size()); ++k) {
    ObjectState state{k, input.rule, input.cloud, Evidence(input.cloud.size(), 1), {}};
    state.rule.label_threshold = threshold;
    first_pass(exec, monitor, options, input, state);
    LabelColumns columns = label_gaussians(state.rule, state.evidence)[0];
    for (int pass = 1; pass < options.passes && !monitor.stop_requested(); ++pass) {
      later_pass(exec, input, state);
      const std::vector<float> label = state.label();
      for (std::size_t i = 0; i < label.size(); ++i) {
        columns.label[i] = label[i];
        if (state.evidence.views[i] > 0) columns.prob[i] = float(state.evidence.prob(i, 0));
      }
    }
    result.figures["views_accepted"] += double(state.accepted.size());
    result.figures["object_gaussians"] += labelled_count(columns);
    result.labels.push_back(std::move(columns));
  }
  restore_fixed(input, {}, result.labels);
  result.figures["threshold"] = threshold;
  result.converged = !monitor.stop_requested();
  return result;
}

}  // namespace ngs
