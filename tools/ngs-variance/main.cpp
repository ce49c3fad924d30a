// ngs-variance: scene.json -> labelled PLY with evidence, variance and the boundary set. Algorithm 1, step 1.
#include "ngs/io/gaussian_ply.h"
#include "ngs/io/masks.h"
#include "ngs/io/scene_json.h"
#include "ngs/stages/render_options.h"
#include "ngs/stages/variance_stage.h"
#include "shared/tool.h"

namespace {

using namespace ngs;

/// Counts for the report; refuses an empty boundary set unless the user allows it.
void report_labels(cli::Run& run, const Scene& scene, const VarianceOptions& options, const std::vector<LabelColumns>& labels) {
  std::int64_t boundary_total = 0;
  const auto count = [](const std::vector<float>& column) { return std::count(column.begin(), column.end(), 1.f); };
  for (std::size_t k = 0; k < labels.size(); ++k) {
    const std::int64_t boundary = count(labels[k].boundary);
    boundary_total += boundary;
    run.result()["objects"].push_back({{"name", scene.objects[k].name}, {"boundary", boundary}, {"object", count(labels[k].label)}});
  }
  run.result()["never_seen"] = std::count(labels[0].views.begin(), labels[0].views.end(), 0.f);
  run.result()["boundary"] = boundary_total;
  if (boundary_total == 0)
    run.nothing_found("no Gaussian has a normalised mask variance above tau = " + std::to_string(options.tau),
                      "lower --tau, or check the masks: ngs-scene check scene.json");
}

}  // namespace

int main(int argc, char** argv) {
  cli::Tool tool("ngs-variance", "Find the boundary Gaussians: evidence of all masks, normalised variance (Eq. 3).",
                 {"ngs-variance scene.json -o boundary.ply", "ngs-variance scene.json -o boundary.ply --tau 0.5 --criterion between-views"});
  VarianceOptions options;
  RasterOptions raster;
  tool.options(options);
  tool.options(raster);
  const cli::Input& scene_json = tool.input("scene", "scene.json written by ngs-scene");
  const cli::Output& out = tool.output("-o,--output", "labelled PLY");

  return tool.run(argc, argv, [&](cli::Run& run) {
    const Scene scene = io::read_scene_json(scene_json.path);
    run.add_input("model", scene.model_path);
    io::GaussianPly ply = io::read_gaussian_ply(scene.model_path);
    const std::vector<std::size_t> views = training_views(scene);
    const Evidence evidence = accumulate_evidence(run.exec(), run.monitor(), ply.cloud, scene, views, splat_options(raster, ply.cloud),
                                                  [&](std::size_t view) { return io::load_masks(scene, view); });
    const std::vector<LabelColumns> labels = label_gaussians(options, evidence);
    report_labels(run, scene, options, labels);
    std::vector<io::NamedLabels> named;
    for (std::size_t k = 0; k < labels.size(); ++k) named.push_back({scene.objects[k].name, labels[k]});
    const auto timed = run.monitor().scope("write");
    io::write_labelled_ply(out.path, ply, named);
    return 0;
  });
}
