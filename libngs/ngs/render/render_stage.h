#pragma once
// Renders of a labelled model from the scene's cameras.
#include <string>
#include <vector>

#include "ngs/core/monitor.h"
#include "ngs/ops/optim/resident.h"
#include "ngs/ops/splat/splat.h"
#include "ngs/options/field.h"
#include "ngs/problem/problem.h"
#include "ngs/render/background.h"
#include "ngs/scene/scene.h"

namespace ngs {

struct RenderOptions {
  std::string views = "all";
  std::vector<std::string> layers;
  double scale = 1.0;
  bool amodal = false;
  double threshold = 0.5;
  std::string background;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.views, Text{"views", "train|held-out|all|NAME,...", "Cameras to render"});
    visit(self.layers, Text{"layers", "color,mask,alpha,depth,labels,overlay", "Images to render; default: mask"});
    visit(self.scale, Field<double>{"scale", "",
                                    "Image size relative to the scene's working size; 0: that of the photos", 0, 64.0});
    visit(self.amodal, Flag{"amodal", "Render the object's mask without occluders"});
    visit(self.threshold,
          Field<double>{"threshold", "", "PNG masks: 255 where the rendered mask exceeds this", 0.0, 1.0});
    visit(self.background, background_option());
  }
};

/// Indices of the selected views. Throws kUsage for an unknown or ambiguous name.
std::vector<std::size_t> select_views(const Scene& scene, const std::string& selection);

/// How a labelled model is rendered, and which images in addition to alpha. Modal: label channels composited with the
/// full model. Amodal: for each object the alpha of its own Gaussians (label > 0.5) alone.
struct LabelledRequest {
  SplatOptions splat = {};
  Vec3<float> background{0, 0, 0};
  bool amodal = false, colour = true, depth = true, labels = true;
};

RenderedView render_labelled(const Exec& exec, const LabelledModel& model, const Camera& camera,
                             const LabelledRequest& request);

/// Renders only the label channels of modal views of one model. With a device: copies them to its memory, once for all
/// views. `cloud` must outlive this object.
class LabelChannels {
 public:
  LabelChannels(const Exec& exec, const GaussianCloud& cloud, const std::vector<LabelColumns>& objects);
  /// [H, W, K]; 0 in tiles without a labelled Gaussian. `tiles_touching` as in RenderRequest; null: of all labels.
  ImageF view(const Exec& exec, const Camera& camera, const SplatOptions& splat,
              const std::uint8_t* tiles_touching = nullptr) const;
  /// The same for callers that use only label_is_foreground() of the result: 0 in tiles without an object.
  ImageF masks(const Exec& exec, const Camera& camera, const SplatOptions& splat) const;
  std::size_t objects() const { return objects_; }
  const GaussianCloud& cloud() const { return cloud_; }

 private:
  const GaussianCloud& cloud_;
  std::size_t objects_;
  std::vector<float> label_;            // [N, K]
  std::vector<std::uint8_t> object_;    // [N] 1: some label is high enough for a foreground pixel
  std::vector<std::uint8_t> labelled_;  // [N] 1: some label is not 0
  Resident resident_;                   // label_
};

/// A labelled model, prepared for renderings by the threads of a loop over views. The cloud must outlive it.
struct PreparedModel {
  PreparedModel(const Exec& all_threads, const SplatOptions& options, const LabelledModel& model)
      : exec(all_threads.one_thread()),
        splat(prepared_for(all_threads, options, model.cloud)),
        labels(all_threads, model.cloud, model.labels) {}
  Exec exec;           // of a task
  SplatOptions splat;  // prepared for the cloud
  LabelChannels labels;
};

/// Renders each object of a model alone. With a device, the objects' flags are copied once. `cloud` must outlive this.
class ObjectsAlone {
 public:
  ObjectsAlone(const Exec& exec, const GaussianCloud& cloud, const std::vector<LabelColumns>& objects);
  /// Opacity of object k, [H, W, 1].
  ImageF view(const Exec& exec, std::size_t k, const Camera& camera, const SplatOptions& splat) const;
  std::size_t size() const { return member_.size(); }

 private:
  const GaussianCloud& cloud_;
  std::vector<std::vector<std::uint8_t>> member_;  // [K][N] 1: of the object
  Resident resident_;                              // member_
};

/// Makes a modal view amodal by replacing its label channels.
void show_objects_alone(const Exec& exec, const LabelledModel& model, const Camera& camera, const SplatOptions& splat,
                        RenderedView& view);

/// Label map: the id of the object with the largest mask value above `threshold`, else 0. Without `ids`, the index + 1.
ImageU16 label_map(const RenderedView& view, double threshold, const std::vector<std::uint16_t>& ids = {});

/// The colour image with a contour of 1 px around every mask and its inside tinted, one hue per object.
ImageU8 overlay_picture(const RenderedView& view, double threshold);

}  // namespace ngs
