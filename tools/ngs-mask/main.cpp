// ngs-mask: strokes or boxes on one photo -> masks of all views, through the splat.
#include "ngs/io/ply/gaussian_ply.h"
#include "ngs/io/scene/scene_json.h"
#include "ngs/stages/masks/hand_prompt.h"
#include "ngs/stages/render/render_options.h"
#include "prompt_input.h"
#include "segmenters.h"
#include "shared/scene/scene_model.h"
#include "shared/tool.h"
#include "views.h"

namespace {

using namespace ngs;

struct ViewOptions {
  std::string view;
  int detail = 2;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.view, Text{"view", "NAME", "the view that the prompts are of; default: as they say"});
    visit(self.detail,
          Field<int>{"detail", "",
                     "segment and write at up to this many times the scene's working size, as far "
                     "as the photos have the pixels",
                     1, 16});
  }
};

}  // namespace

int main(int argc, char** argv) {
  cli::Tool tool("ngs-mask", "Make masks of all views from strokes or boxes on one photo.",
                 {"ngs-mask scene.json --prompts strokes.json -o masks/",
                  "ngs-mask scene.json --view IMG_4038 --object-scribbles pos.png --background-scribbles "
                  "neg.png -o masks/",
                  "ngs-mask scene.json --prompts 0003.png -o masks/ --segmenter 'python3 sam.py {image} "
                  "{prompts} {out}'"});
  SpreadOptions spread;
  ViewOptions which;
  cli::SegmenterOptions segmenter;
  RasterOptions raster;
  tool.options(which);
  tool.options(segmenter);
  tool.options(spread);
  tool.options(raster);
  const cli::Input& scene_json = tool.input("scene", "scene.json written by ngs-scene");
  const cli::Input& model = tool.optional_input("--model", "3DGS PLY; default: the scene's");
  const cli::PromptInputs marks{
      tool.optional_input(
          "--prompts",
          "strokes and boxes as JSON, or a PNG with green (object) and red (background) strokes"),
      tool.optional_input("--object-scribbles", "PNG: all that is not black is the object"),
      tool.optional_input("--background-scribbles", "PNG: all that is not black is not the object")};
  const cli::Output& out = tool.output_dir("-o,--output", "folder for the masks, STEM.png, 0/255");
  const cli::Output& soft =
      tool.optional_output_dir("--soft",
                               "folder for soft masks, 0..255: where the photo and the other "
                               "views agree, and where not");
  tool.stops_on_request();

  return tool.run(argc, argv, [&](cli::Run& run) {
    const Scene scene = io::read_scene_json(scene_json.path);
    if (segmenter.segmenter.empty())
      run.warn_unused({"--points", "--segmenter-timeout-s"}, "without --segmenter");
    else
      run.warn_unused({"--iterations", "--window", "--speck"}, "with --segmenter");
    if (!model) cli::require_model(run, scene, scene_json.path);
    const std::string model_path = model ? model.path : scene.model_path;
    const HandPrompt hand = cli::read_prompts(marks);
    const std::size_t reference = cli::reference_view(run, scene, which.view, hand, marks);
    const io::GaussianPly ply = io::read_gaussian_ply(model_path, io::HigherBands::kCheckOnly);
    cli::MaskViews views(scene, which.detail);
    std::vector<std::string> files;
    for (std::size_t v = 0; v < scene.views.size(); ++v)
      for (const cli::Output* folder : {&out, &soft})
        if (*folder) files.push_back(views.file_in(folder->path, v));
    cli::refuse_over_photos(scene, files);
    const cli::PhotoLoader load = [&](std::size_t view) { return views.photo(view); };
    const Segmenter segment = segmenter.segmenter.empty()
                                  ? cli::grab_cut_segmenter(segmenter, load, run.seed())
                                  : cli::command_segmenter(segmenter, scene, load, run);
    run.result()["views"] = scene.views.size();
    run.result()["reference"] = scene.views[reference].camera.name;
    const Camera& camera = views.cameras()[reference];
    const SpreadInput input{ply.cloud,
                            scene,
                            views.cameras(),
                            views.has_photo(),
                            filter_at_scale(splat_options(raster, ply.cloud, scene), views.scale()),
                            reference,
                            rasterise(hand, camera.width_px, camera.height_px),
                            segment,
                            [&](std::size_t view, const SpreadView& result) {
                              views.keep(run, view, result, out.path, soft.path);
                            }};
    if (!input.has_photo[reference])
      throw Error(ErrorCode::kInconsistent,
                  "view " + camera.name + ": it has no photo, expected one under the strokes");
    if (run.dry_run()) return run.plan(views.plan(ply.cloud, spread.passes)), cli::kDone;
    spread_masks(run.exec(), run.monitor(), spread, input);
    if (run.stop_code() == 0) views.finish(run);
    return run.stop_code();
  });
}
