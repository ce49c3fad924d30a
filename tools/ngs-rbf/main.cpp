// ngs-rbf: reads a boundary PLY and a query PLY, writes a query PLY with interpolated features. Algorithm 1, step 5.
#include "ngs/field/sample_stage.h"
#include "ngs/io/ply/query_ply.h"
#include "shared/scene/scene_model.h"
#include "shared/tool.h"

int main(int argc, char** argv) {
  using namespace ngs;
  cli::Tool tool("ngs-rbf", "Interpolate boundary features at query points (Eqs. 8-9).",
                 {"ngs-rbf boundary.ply queries.ply -o field.ply",
                  "ngs-rbf boundary.ply queries.ply -o field.ply --neighbours 16 --width 0.35"});
  RbfOptions options;
  tool.options(options);
  tool.runs_on_device();
  const cli::Input& boundary_ply = tool.input("boundary", "PLY written by ngs-variance");
  const cli::Input& query_ply = tool.input("queries", "PLY written by ngs-sample, or any PLY with x y z");
  const cli::Output& out = tool.output("-o,--output", "query PLY with f_inter_*, neighbours and weights");

  return tool.run(argc, argv, [&](cli::Run& run) {
    if (options.width != "auto") run.warn_unused({"--width-factor"}, "without --width auto");
    const io::GaussianPly ply = io::read_gaussian_ply(boundary_ply.path);
    const BoundarySet boundary = cli::boundary_of(run, ply, boundary_ply.path);
    QueryField field = io::read_query_ply(query_ply.path);
    run.result()["queries"] = field.size();
    if (run.dry_run()) {
      const std::int64_t bytes = field.size() * (32 + 12 + 8 * options.neighbours);
      run.plan({{"queries", field.size()}, {"output_mib", double(bytes) / 1048576}});
      return 0;
    }
    const RbfSummary summary = interpolate_features(run.exec(), run.monitor(), options, boundary, field);
    run.result()["width"] = summary.width;
    run.result()["far_queries"] = summary.far_queries;
    run.result()["mean_nearest"] = summary.mean_nearest;
    const auto timed = run.monitor().scope("write");
    io::write_query_ply(out.path, field);
    return 0;
  });
}
