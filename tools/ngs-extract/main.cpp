// ngs-extract: reads a labelled PLY, or any splat and the place of the object; writes object and background as plain
// splats, and decided labels; imports hand edits.
#include <optional>

#include "extractor.h"
#include "fill_output.h"
#include "inpainted_input.h"
#include "ngs/edit/finish/finish_stage.h"
#include "ngs/edit/select/region.h"
#include "ngs/io/scene/scene_json.h"
#include "outputs.h"
#include "shared/tool.h"

namespace {

/// Throws kUsage for an invalid rule; warns about unused options.
void check_options(ngs::cli::Run& run, const ngs::ExtractOptions& options, const ngs::RegionOptions& region,
                   const ngs::cli::Outputs& out) {
  ngs::parse_extract_rule(options.rule);
  (void)ngs::parse_region(region);
  if (region.drop_below_plane != "auto" && !ngs::cli::turns_any(out))
    run.warn_unused({"--up"}, "without --drop-below-plane auto or a part in a format other than PLY");
  if (!ngs::cli::turns_any(out)) run.warn_unused({"--unit"}, "without a part in a format other than PLY");
  if (region.cluster_at.empty() && region.largest == 0)
    run.warn_unused({"--cluster-side"}, "without --cluster-at or --largest");
}

struct Options {
  ngs::ExtractOptions extract;
  ngs::cli::SelectOptions select;
  ngs::RegionOptions region;
  ngs::InpaintOptions inpaint;
  ngs::FillOptions fill;
  ngs::finish::FinishOptions finish;

  void declare(ngs::cli::Tool& tool) {
    tool.options(extract);
    tool.options(select);
    tool.options(region);
    tool.options(inpaint);
    tool.options(fill);
    tool.options(finish);
  }
};

}  // namespace

int main(int argc, char** argv) {
  using namespace ngs;
  cli::Tool tool("ngs-extract", "Write the object and the background of a labelled model as plain splats.",
                 {"ngs-extract labelled.ply --object-ply object.ply --background-ply background.ply",
                  "ngs-extract labelled.ply --import edited.ply --labelled corrected.ply --object-ply object.ply"});
  Options options;
  options.declare(tool);
  const cli::Input& labelled =
      tool.input("labelled", "labelled PLY of ngs-variance or ngs-joint; with a region any splat");
  const cli::Input& edited =
      tool.optional_input("--import", "hand-edited splat whose rows (or selected rows) are the object");
  const cli::Input& scene_json =
      tool.optional_input("--scene", "scene.json: its views clip the object; inpainting and strokes need it");
  const cli::Input& inpainted =
      tool.optional_input("--inpainted", "folder of images/ of --inpaint, inpainted: fill the hole from them");
  const cli::Inputs& strokes = tool.inputs("--strokes",
                                           "strokes on views of the scene, as for ngs-mask --prompts: keep only "
                                           "components that they touch (repeatable, or PATH,PATH)");
  const cli::Outputs out = cli::declare_outputs(tool);

  return tool.run(argc, argv, [&](cli::Run& run) {
    check_options(run, options.extract, options.region, out);
    cli::require_one_of(out);
    cli::check_inpaint_options(run, out.inpaint, inpainted, scene_json);
    cli::check_fill_options(run, options.fill, inpainted, scene_json, out);
    if (!scene_json) run.warn_unused({"--finish"}, "without --scene");
    const bool finishes = options.finish.finish && scene_json;
    cli::check_strokes(run, strokes, scene_json);
    cli::check_formats(out);
    std::optional<Scene> scene;
    if (scene_json) scene = io::read_scene_json(scene_json.path);
    if (out.inpaint) cli::check_inpaint_folder(*scene, scene_json.path, out.inpaint.path, {labelled.path, edited.path});
    cli::Extractor extractor(run, io::read_gaussian_ply(labelled.path, options.select.reading()), options.extract,
                             options.region, options.select);
    cli::Marks marks;
    if (strokes) marks = cli::read_prompts(run, *scene, options.select.view, strokes.paths);
    std::optional<cli::InpaintedPictures> pictures;
    if (inpainted) pictures.emplace(*scene, inpainted.path, options.inpaint);
    if (run.dry_run()) return cli::kDone;
    if (edited) extractor.import(edited.path);
    std::optional<cli::NumpyLabels> labels;
    if (out.npz) labels.emplace(extractor);
    extractor.decide();
    if (strokes) extractor.keep_touched(cli::stroke_weights_of(run, *scene, marks, extractor.cloud()));
    if (scene && !scene->renders) cli::report_unseen_surface(run, extractor, *scene);
    const bool fills = out.background_filled || out.filled;
    const cli::FillOutput fill(run, extractor, fills ? options.fill : FillOptions{FillKind::kOff},
                               pictures ? &*pictures : nullptr);
    const auto timed = run.monitor().scope("write");
    cli::write_objects(run, extractor, finishes ? &*scene : nullptr, out);
    fill.write(out);
    if (out.decided) extractor.write_labelled(out.decided.path, false);
    if (labels) labels->write(out.npz.path, extractor);
    if (out.inpaint) cli::write_inpainting(run, extractor, options.inpaint, *scene, out.inpaint.path);
    if (out.supersplat) extractor.write_labelled(out.supersplat.path, true);
    return cli::kDone;
  });
}
