#include "flash_cut.h"

#include <algorithm>
#include <filesystem>
#include <limits>

#include "ngs/core/error.h"
#include "ngs/io/formats/write_splat.h"
#include "ngs/io/image/image_file.h"
#include "ngs/io/ply/gaussian_ply.h"
#include "ngs/io/scene/scene_json.h"
#include "ngs/scene/view_names.h"
#include "ngs/stages/live/ball_cut.h"
#include "ngs/stages/orbit/orbit_stage.h"
#include "ngs/stages/render/render_options.h"
#include "shared/scene/prompt_input.h"

namespace ngs::front {
namespace {

namespace fs = std::filesystem;

constexpr int kMostViews = 32;

void write_masks(const std::string& folder, const Scene& scene, const live::BallCut& cut) {
  std::error_code ignored;
  fs::remove_all(folder, ignored);
  fs::create_directories(folder);
  const std::vector<std::string> names = output_names(scene.views);
  for (std::size_t v = 0; v < names.size(); ++v) {
    ImageU8 mask(cut.cameras[v].width_px, cut.cameras[v].height_px, 1);
    for (std::size_t p = 0; p < mask.data.size(); ++p) mask.data[p] = cut.views[v].mask[p] ? 255 : 0;
    io::write_png(folder + "/" + names[v] + ".png", mask);
  }
}

void write_models(cli::Run& run, const std::string& out, const io::GaussianPly& ply, LabelColumns labels) {
  std::vector<std::uint8_t> keep(labels.label.begin(), labels.label.end()), rest(keep.size());
  for (std::size_t i = 0; i < keep.size(); ++i) rest[i] = !keep[i];
  for (const std::string& note : io::write_splat(out + "/object.ply", ply, keep)) run.monitor().warn(note);
  for (const std::string& note : io::write_splat(out + "/background.ply", ply, rest)) run.monitor().warn(note);
  const std::vector<io::NamedLabels> objects{{"object", std::move(labels)}};
  io::write_labelled_ply(out + "/labelled.ply", ply, objects);
}

}  // namespace

std::string most_flash_views(int views) { return std::to_string(std::max(views, kMostViews)); }

std::optional<FlashFigures> flash_cut(cli::Run& run, const FlashInputs& in) {
  const double start_s = wall_seconds();
  Monitor& monitor = run.monitor();
  const io::GaussianPly ply = [&] {
    const auto timed = monitor.scope("read");
    return io::read_gaussian_ply(in.model);
  }();
  const Scene scene = io::read_scene_json(in.scene);
  orbit::Ball ball{{0, 0, 0}, std::numeric_limits<double>::infinity()};
  if (!in.around.empty()) ball = orbit::parse_ball(in.around);
  const live::BallCut cut = live::cut_in_ball(run.exec(), monitor,
                                              {ply.cloud, ball, scene, splat_options({}, ply.cloud, scene),
                                               cli::read_prompts(run, scene, in.view, in.strokes)});
  if (monitor.stop_requested()) return std::nullopt;
  if (cut.object == 0)
    run.nothing_found("no Gaussian of the ball is the object by these strokes", "draw more strokes on the object");
  {
    const auto timed = monitor.scope("write");
    write_masks(in.out + "/masks", scene, cut);
    write_models(run, in.out, ply, cut.labels);
  }
  FlashFigures figures{cut.object, ply.cloud.size() - cut.object, cut.in_ball, cut.views.size(), 0, 0};
  for (const SpreadView& view : cut.views)
    figures.segmented += view.source == MaskSource::kReference || view.source == MaskSource::kSegmented;
  figures.wall_s = wall_seconds() - start_s;
  return figures;
}

}  // namespace ngs::front
