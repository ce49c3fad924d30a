// ngs-render: renders colour, mask, alpha, depth and labels of a model at the cameras of a scene.json.
#include <algorithm>
#include <optional>
#include <set>

#include "ngs/io/image/photo.h"
#include "ngs/io/ply/gaussian_ply.h"
#include "ngs/render/render_options.h"
#include "ngs/render/render_stage.h"
#include "render_output.h"
#include "shared/scene/scene_model.h"
#include "shared/tool.h"

namespace {

using namespace ngs;

void warn_unused(cli::Run& run, const std::set<std::string>& layers) {
  if (!layers.contains("color") && !layers.contains("overlay"))
    run.warn_unused({"--background"}, "without the layer color or overlay");
  if (!layers.contains("mask") && !layers.contains("labels") && !layers.contains("overlay"))
    run.warn_unused({"--amodal", "--threshold"}, "without the layer mask, labels or overlay");
}

/// The camera at the size of --scale; 0: the size of the photos.
Camera camera_of(const Scene& scene, std::size_t view, const RenderOptions& options) {
  const Camera& working = scene.views[view].camera;
  const io::ImageSize size = options.scale > 0 ? io::ImageSize{scaled_size_px(working.width_px, options.scale),
                                                               scaled_size_px(working.height_px, options.scale)}
                                               : io::full_size(scene, view);
  return resized(working, size.width_px, size.height_px);
}

/// Renders the images that the layers need.
class Renderer {
 public:
  Renderer(const Exec& exec, const LabelledModel& model, const std::set<std::string>& layers, LabelledRequest request)
      : exec_(exec), model_(model), request_(std::move(request)) {
    request_.colour = layers.contains("color") || layers.contains("overlay");
    request_.depth = layers.contains("depth");
    request_.labels = layers.contains("mask") || layers.contains("labels") || layers.contains("overlay");
    const bool only_labels = request_.labels && !request_.colour && !request_.depth && !layers.contains("alpha");
    if (only_labels && !request_.amodal) labels_.emplace(exec, model.cloud, model.labels);
  }
  RenderedView view(const Camera& camera) const {
    if (!labels_) return render_labelled(exec_, model_, camera, request_);
    return {camera.width_px, camera.height_px, {}, labels_->view(exec_, camera, request_.splat), {}, {}};
  }

 private:
  Exec exec_;
  LabelledModel model_;
  LabelledRequest request_;
  std::optional<LabelChannels> labels_;  // if nothing else is needed
};

std::vector<std::size_t> wanted_views(cli::Run& run, const Scene& scene, const std::string& views) {
  std::vector<std::size_t> wanted = select_views(scene, views);
  if (wanted.empty())
    run.nothing_found(
        "--views " + views + ": none of the scene's " + std::to_string(scene.views.size()) + " views, expected some",
        "render all views with --views all");
  return wanted;
}

}  // namespace

int main(int argc, char** argv) {
  cli::Tool tool("ngs-render", "Render colour, masks, alpha, depth and labels of a model at the scene's cameras.",
                 {"ngs-render scene.json labelled.ply --views held-out --layers mask -o masks/",
                  "ngs-render scene.json labelled.ply --layers color,mask,depth --format exr -o layers/"});
  RenderOptions options;
  RasterOptions raster;
  picture::OutputOptions format;
  tool.options(options);
  tool.options(raster);
  tool.options(format);
  tool.runs_on_device();
  const cli::Input& scene_json = tool.input("scene", "scene.json written by ngs-scene");
  const cli::Input& model =
      tool.input("model", "any 3DGS model (.ply, .spz, .sog, .splat, .ksplat, .glb); masks need a labelled PLY");
  const cli::Output& out = tool.output_dir("-o,--output", "folder for the images");

  return tool.run(argc, argv, [&](cli::Run& run) {
    Scene scene = cli::read_scene(run, scene_json.path);
    const io::GaussianPly ply = io::read_gaussian_ply(model.path);
    const picture::Objects objects = picture::objects_of(ply, scene);
    const std::set<std::string> layers = picture::parse_layers(options.layers, objects, format.format);
    warn_unused(run, layers);
    choose_background(options.background, run.monitor(), scene);
    const double scale = options.scale > 0 ? options.scale : 1 / scene.image_scale;
    const SplatOptions splat = filter_at_scale(splat_options(raster, ply.cloud, scene), scale);
    const std::vector<std::size_t> views = wanted_views(run, scene, options.views);
    const std::vector<std::string> names = picture::file_names(scene, format.names);
    std::vector<std::string> files;
    for (std::size_t n = 0; out && n < views.size(); ++n)
      std::ranges::move(picture::files_of({out.path, names[views[n]]}, objects, layers, format.format),
                        std::back_inserter(files));
    cli::refuse_over_photos(scene, files);
    run.result()["views"] = views.size();
    for (std::size_t k = 0; layers.contains("labels") && k < objects.names.size(); ++k)
      run.result()["labels"][objects.names[k]] = objects.ids[k];
    if (run.dry_run()) {
      run.plan({{"views", views.size()}, {"layers", layers}});
      return 0;
    }
    run.needs_device_memory(cli::device_bytes(double(ply.cloud.size()), ply.cloud.rest_count()));
    const Renderer renderer(run.exec(), {ply.cloud, objects.columns}, layers,
                            {prepared_for(run.exec(), splat, ply.cloud), background_of(scene), options.amodal});
    for (std::size_t n = 0; n < views.size(); ++n) {
      const Camera camera = camera_of(scene, views[n], options);
      RenderedView view = [&] {
        const auto timed = run.monitor().scope("render");
        return renderer.view(camera);
      }();
      const auto timed = run.monitor().scope("write");
      picture::write_view({out.path, names[views[n]]}, view, {objects, layers, format.format, options.threshold});
      run.monitor().progress(std::int64_t(n) + 1, std::int64_t(views.size()));
    }
    return 0;
  });
}
