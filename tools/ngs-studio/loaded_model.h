#pragma once
// The model shown: a splat, with the cameras of its scene if there is one.
#include <string>

#include "ngs/interactive/kept_strokes.h"
#include "ngs/io/ply/gaussian_ply.h"
#include "ngs/scene/scene.h"

namespace ngs::studio {

struct LoadedModel {
  /// `source`: a splat, or a scene.json that names one. Throws the errors of the readers.
  LoadedModel(const Exec& exec, const std::string& source);
  LoadedModel(const LoadedModel&) = delete;
  LoadedModel& operator=(const LoadedModel&) = delete;

  bool is_scene = false;
  Scene scene;  // for a splat without a scene: world unit and model path only, no views
  io::GaussianPly ply;
  SplatOptions splat;
  live::InitialViewpoint first;

  live::Model model() const { return {ply.cloud, splat, background_of(scene)}; }
};

/// Viewpoint of a scene's camera, with the principal point moved to the image centre.
live::Viewpoint viewpoint_of_view(const Camera& camera, double distance);

/// A labelled result of Refine, made from the marks of an object.
struct RefinedModel {
  RefinedModel(const Exec& exec, const std::string& labelled, const LoadedModel& of, const live::ObjectMarks& marks);
  RefinedModel(const RefinedModel&) = delete;
  RefinedModel& operator=(const RefinedModel&) = delete;

  io::GaussianPly ply;
  SplatOptions splat;
  live::RestoredSelection found;  // `labels`: with what lies under object strokes
};

}  // namespace ngs::studio
