// ngs-mask: strokes or boxes on some photos -> masks of all views, by way of the splat.
#include "ngs/io/ply/gaussian_ply.h"
#include "ngs/render/render_options.h"
#include "segmenters.h"
#include "shared/scene/prompt_input.h"
#include "shared/scene/scene_model.h"
#include "shared/tool.h"
#include "views.h"

namespace {

using namespace ngs;

struct Options {
  SpreadOptions spread;
  cli::ViewOptions which;
  cli::SegmenterOptions segmenter;
  RasterOptions raster;

  bool runs_a_program() const { return !segmenter.segmenter.empty(); }
};

struct Files {
  const cli::Input &scene, &model;
  const cli::PromptInputs marks;
  const cli::Output &out, &soft;
};

int make_masks(cli::Run& run, const Options& options, const Files& files) {
  run.warn_unused({"--annotations"}, "without --everything");
  const Scene scene = cli::read_scene(run, files.scene.path);
  if (options.runs_a_program())
    run.warn_unused({"--window"}, "with --segmenter");
  else
    run.warn_unused({"--segmenter-timeout-s"}, "without --segmenter");
  if (!files.model) cli::require_model(run, scene, files.scene.path);
  const std::string model_path = files.model ? files.model.path : scene.model_path;
  const auto marks = cli::read_marks(run, scene, options.which.view, files.marks);
  const io::GaussianPly ply = io::read_gaussian_ply(model_path, {io::HigherBands::kCheckOnly});
  cli::MaskViews views(scene, options.which.detail);
  views.refuse_over_photos({files.out.path, files.soft.path});
  const cli::PhotoLoader load = [&](std::size_t view) { return views.photo(view); };
  const Segmenter segment = options.runs_a_program()
                                ? cli::command_segmenter(options.segmenter, scene, load, run)
                                : cli::grab_cut_segmenter(run.exec(), options.segmenter, load, run.seed());
  run.result()["views"] = scene.views.size();
  auto marked = views.rasterised(run, marks);
  if (run.dry_run()) return run.plan(views.plan(ply.cloud, options.spread.passes)), cli::kDone;
  run.needs_device_memory(cli::device_bytes(double(ply.cloud.size()), ply.cloud.rest_count()));
  const SplatOptions splat = filter_at_scale(splat_options(options.raster, ply.cloud, scene), views.scale());
  const SpreadInput input{ply.cloud,
                          scene,
                          views.cameras(),
                          views.has_photo(),
                          prepared_for(run.exec(), splat, ply.cloud),
                          std::move(marked),
                          segment,
                          [&](std::size_t view, const SpreadView& result) {
                            views.store(run, view, result, files.out.path, files.soft.path);
                          }};
  spread_masks(run.exec(), run.monitor(), options.spread, input);
  if (run.stop_code() == 0) views.finish(run);
  return run.stop_code();
}

}  // namespace

int main(int argc, char** argv) {
  cli::Tool tool("ngs-mask", "Make masks of all views from strokes, polygons or boxes on some photos.",
                 {"ngs-mask scene.json --prompts strokes.json -o masks/",
                  "ngs-mask scene.json --prompts 0003.png --prompts 0017.png -o masks/",
                  "ngs-mask scene.json --view IMG_4038 --object-scribbles pos.png --background-scribbles "
                  "neg.png -o masks/",
                  "ngs-mask scene.json --prompts 0003.png -o masks/ --segmenter 'python3 sam.py {image} "
                  "{prompts} {out}'",
                  "ngs-mask scene.json --everything --annotations coco.json -o masks_everything/"});
  Options options;
  tool.options(options.which);
  tool.options(options.segmenter);
  tool.options(options.spread);
  tool.options(options.raster);
  const cli::Input& scene_json = tool.input("scene", "scene.json written by ngs-scene");
  const cli::Input& model = tool.optional_input("--model", "3DGS PLY; default: the model of the scene");
  const cli::PromptInputs marks{
      tool.inputs(
          "--prompts",
          "strokes, polygons and boxes as JSON, or a photo with green (object) and red (background) paint on it, "
          "or a PNG of such paint alone (repeatable, or PATH,PATH)"),
      tool.optional_input("--object-scribbles", "PNG: pixels that are not black are object"),
      tool.optional_input("--background-scribbles", "PNG: pixels that are not black are background")};
  const cli::Input& annotations =
      tool.optional_input("--annotations", "masks for --everything: COCO or labelme JSON, or a folder of it");
  const cli::Output& out = tool.output_dir("-o,--output", "folder for the masks, STEM.png, 0/255, or 16-bit id maps");
  const cli::Output& soft = tool.optional_output_dir("--soft",
                                                     "folder for soft masks, 0..255: agreement of the photo with "
                                                     "the other views");
  tool.stops_on_request();
  tool.runs_on_device();

  return tool.run(argc, argv, [&](cli::Run& run) {
    if (!options.segmenter.everything) return make_masks(run, options, {scene_json, model, marks, out, soft});
    return cli::make_everything(run,
                                {options.segmenter, options.which.detail, scene_json.path, annotations.path, out.path});
  });
}
