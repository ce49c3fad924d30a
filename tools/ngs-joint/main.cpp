// ngs-joint: reads scene.json and a labelled PLY, writes a labelled PLY with optimised labels and attributes. Algorithm
// 1, step 6.
#include "ngs/os/process_usage.h"
#include "options.h"
#include "quality_table.h"
#include "run.h"

int main(int argc, char** argv) {
  using namespace ngs;
  const double start_s = wall_seconds() - os::cpu_seconds();  // of the process, with the work before main()
  joint::Options options;
  cli::Tool tool("ngs-joint", "Jointly optimise labels, Gaussians and a NeRF (Eqs. 1-2, 10-20), or run a baseline.",
                 {"ngs-joint scene.json boundary.ply -o labelled.ply"});
  options.declare(tool);
  tool.help("quality",
            [&](bool in_full) -> std::string { return in_full || options.runs_passes() ? joint::kQualityTable : ""; });
  tool.help("effects", [&](bool in_full) { return joint::effects_help(options, in_full); });
  const cli::Input& scene = tool.input("scene", "scene.json written by ngs-scene");
  const cli::Input& boundary = tool.input("boundary", "PLY written by ngs-variance");
  const cli::Input& field = tool.optional_input("--field", "PLY written by ngs-rbf; default: computed here");
  const cli::Input& effects_from =
      tool.optional_input("--effects-from", "report of a run whose decisions on effects are repeated");
  const cli::Output& out = tool.output("-o,--output", "labelled PLY with optimised attributes");
  const cli::Output& trace =
      tool.optional_output("--trace", "one JSON line per step: time, loss terms; per stage: mask scores");
  tool.writes_nothing_if(options.choice.explain);
  tool.stops_on_request();
  tool.runs_on_device();

  return tool.run(argc, argv, [&](cli::Run& run) {
    const joint::Paths paths{scene.path, boundary.path, field.path, effects_from.path, out.path, trace.path};
    return joint::run_method(run, options, paths, start_s);
  });
}
