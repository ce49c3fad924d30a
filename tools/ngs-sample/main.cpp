// ngs-sample: scene.json and a boundary PLY -> a query PLY with a grid of rays per view. Algorithm 1, steps 2-4.
#include "ngs/field/sample_stage.h"
#include "ngs/io/ply/query_ply.h"
#include "ngs/io/scene/scene_json.h"
#include "ngs/render/render_options.h"
#include "ngs/render/render_stage.h"
#include "shared/scene/scene_model.h"
#include "shared/tool.h"

namespace {

struct ViewOptions {
  std::string views = "train";

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.views, ngs::Text{"views", "train|held-out|all|NAME,...", "Views to place query points in"});
  }
};

void report_views(ngs::cli::Run& run, const ngs::QueryField& field) {
  std::int64_t empty = 0;
  for (const ngs::QueryView& view : field.views) {
    empty += view.rows == 0;
    run.result()["views"].push_back({{"name", view.name},
                                     {"box_px", {view.box.min_x, view.box.min_y, view.box.max_x, view.box.max_y}},
                                     {"rows", view.rows},
                                     {"cols", view.cols},
                                     {"mean_depth", view.mean_depth}});
  }
  run.result()["queries"] = field.size();
  run.result()["views_without_boundary"] = empty;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace ngs;
  cli::Tool tool("ngs-sample", "Lay a grid of rays over the boundary in every view and place query points (Eqs. 4-7).",
                 {"ngs-sample scene.json boundary.ply -o queries.ply",
                  "ngs-sample scene.json boundary.ply -o queries.ply --rows 128 --cols 128"});
  SampleOptions options;
  ViewOptions selection;
  RasterOptions raster;
  tool.options(options);
  tool.options(selection);
  tool.options(raster);
  const cli::Input& scene_json = tool.input("scene", "scene.json written by ngs-scene");
  const cli::Input& boundary_ply = tool.input("boundary", "PLY written by ngs-variance");
  const cli::Output& out = tool.output("-o,--output", "query PLY");

  return tool.run(argc, argv, [&](cli::Run& run) {
    const Scene scene = io::read_scene_json(scene_json.path);
    const std::vector<std::size_t> views = select_views(scene, selection.views);
    const io::GaussianPly ply = io::read_gaussian_ply(boundary_ply.path);
    const BoundarySet boundary = cli::boundary_of(run, ply, boundary_ply.path);
    if (run.dry_run()) {
      constexpr std::int64_t kBytesPerQuery = 32;
      const std::int64_t queries = most_queries(options, views.size());
      run.plan({{"views", views.size()},
                {"queries_at_most", queries},
                {"output_mib_at_most", double(queries * kBytesPerQuery) / 1048576}});
      return 0;
    }
    options.world_unit = scene.world_unit;
    const QueryField field =
        sample_queries(run.exec(), run.monitor(), options,
                       {ply.cloud, boundary, scene, views, splat_options(raster, ply.cloud, scene)});
    report_views(run, field);
    if (field.size() == 0 && boundary.size() > 0)
      run.nothing_found("the boundary is not visible in any of the chosen views",
                        "choose other views, or check the poses: ngs-scene check scene.json");
    const auto timed = run.monitor().scope("write");
    io::write_query_ply(out.path, field);
    return 0;
  });
}
