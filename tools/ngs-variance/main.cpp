// ngs-variance: reads scene.json, writes a labelled PLY with evidence, variance and the boundary set. Algorithm 1, step
// 1. Sharded: `--shard i/N --partial part.evidence` for each i, then `ngs-variance merge *.evidence -o out.ply`.
#include "ngs/io/files/content_hash.h"
#include "ngs/io/formats/splat_format.h"
#include "ngs/io/image/masks.h"
#include "ngs/problem/view_list.h"
#include "ngs/render/render_options.h"
#include "shared/cli/dispatch.h"
#include "shared/scene/scene_model.h"
#include "shared/tool.h"
#include "variance_output.h"

namespace {

using namespace ngs;
struct ShardOptions {
  std::string shard = "0/1";
  std::vector<std::string> object;
  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.shard, Text{"shard", "i/N", "Use only part i of N (from 0) of the training views; for --partial"});
    visit(self.object, Text{"object", "NAME", "Use only this object of the scene"});
  }
};

int label_scene(int argc, char** argv) {
  cli::Tool tool(
      "ngs-variance", "Find the boundary Gaussians by the normalised variance of all masks (Eq. 3).",
      {"ngs-variance scene.json -o boundary.ply", "ngs-variance scene.json --shard 0/8 --partial part0.evidence"});
  VarianceOptions options;
  RasterOptions raster;
  ShardOptions shard;
  MaskAgreementOptions agreement;
  tool.options(options);
  tool.options(agreement);
  tool.options(raster);
  tool.options(shard);
  tool.runs_on_device();
  const cli::Input& scene_json = tool.input("scene", "scene.json written by ngs-scene");
  const cli::Output& out = tool.optional_output("-o,--output", "labelled PLY");
  const cli::Output& partial = tool.optional_output("--partial", "evidence of these views, for `ngs-variance merge`");
  const cli::Output& exr =
      tool.optional_output_dir("--exr", "folder for one EXR per view: mask, prob, variance, boundary");

  return tool.run(argc, argv, [&](cli::Run& run) {
    check_tau(options);
    const Scene scene = with_objects(cli::read_scene(run, scene_json.path), shard.object);
    cli::require_model(run, scene, scene_json.path);
    if (!out && !partial)
      throw Error(ErrorCode::kUsage, "no output is given", "give -o boundary.ply or --partial part.evidence");
    io::require_ply_output(out.path);
    const std::vector<std::size_t> views = variance::shard_of(training_views(scene), shard.shard);
    if (out && views.size() != training_views(scene).size())
      throw Error(ErrorCode::kUsage,
                  "-o requires the evidence of all views, --shard " + shard.shard + " is only a part",
                  "write parts with --partial and merge them");
    const auto bands = exr ? io::HigherBands::kRead : io::HigherBands::kCheckOnly;
    const io::GaussianPly ply = io::read_gaussian_ply(scene.model_path, {bands});
    run.result()["views"] = views.size();
    if (run.dry_run()) return run.plan(variance::memory_plan(ply.cloud, scene, views.size())), 0;
    run.needs_device_memory(cli::device_bytes(double(ply.cloud.size()), ply.cloud.rest_count()));
    const EvidenceInputs in{ply.cloud, scene, views, splat_options(raster, ply.cloud, scene),
                            [&](std::size_t view) { return io::load_masks(scene, view); }};
    if (out) variance::check_masks(run, agreement, in);
    io::EvidencePart part;
    part.evidence = accumulate_evidence(run.exec(), run.monitor(), in);
    if (partial) {
      part.model_hash = io::content_hash(scene.model_path).xxh3;
      if (!run.comes_from_stream(scene_json)) part.scene_path = scene_json.path;
      part.made_with = variance::made_with(scene_json.path, splat_options(raster, ply.cloud, scene));
      for (const SceneObject& object : scene.objects) part.objects.push_back(object.name);
      for (const std::size_t view : views) part.views.push_back(scene.views[view].camera.name);
      io::write_evidence(partial.path, part,
                         run.goes_to_stdout(partial) ? io::StoredPaths::kAbsolute : io::StoredPaths::kRelative);
    }
    if (!out) return 0;
    const auto labelled = variance::label(options, scene, ply, std::move(part.evidence));
    variance::write_labels(run, labelled, out.path);
    if (exr) variance::write_exr(run, labelled, splat_options(raster, ply.cloud, scene), exr.path);
    return 0;
  });
}

int merge_parts(int argc, char** argv) {
  cli::Tool tool("ngs-variance merge", "Merge evidence files; the result has the same bytes as one run over all views.",
                 {"ngs-variance merge part0.evidence part1.evidence -o boundary.ply"});
  VarianceOptions options;
  tool.options(options);
  const cli::Input& scene_json = tool.optional_input("--scene", "scene.json; default: the one named in the parts");
  const cli::Inputs& parts = tool.inputs("parts", "files written with --partial");
  const cli::Output& out = tool.output("-o,--output", "labelled PLY");

  return tool.run(argc, argv, [&](cli::Run& run) {
    check_tau(options);
    io::require_ply_output(out.path);
    io::EvidencePart sum = io::merge_evidence(parts.paths);
    const Scene scene = variance::scene_of(run, sum, scene_json.path);
    variance::check_complete(sum, scene);
    const io::GaussianPly ply = io::read_gaussian_ply(scene.model_path, {io::HigherBands::kCheckOnly});
    if (run.dry_run()) return 0;
    variance::write_labels(run, variance::label(options, scene, ply, std::move(sum.evidence)), out.path);
    return 0;
  });
}

}  // namespace

int main(int argc, char** argv) {
  return ngs::cli::dispatch(
      argc, argv,
      {{"", label_scene, "label the Gaussians of a scene"}, {"merge", merge_parts, "merge partial evidence"}});
}
