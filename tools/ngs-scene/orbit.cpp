#include <algorithm>
#include <charconv>
#include <cstdio>
#include <filesystem>

#include "check_report.h"
#include "commands.h"
#include "contact_sheet.h"
#include "ngs/backend/for_each.h"
#include "ngs/core/formatted.h"
#include "ngs/io/capture/capture_source.h"
#include "ngs/io/files/atomic_file.h"
#include "ngs/io/files/folder_index.h"
#include "ngs/io/files/text_lines.h"
#include "ngs/io/image/image_file.h"
#include "ngs/io/ply/gaussian_ply.h"
#include "ngs/io/scene/import_scene.h"
#include "ngs/io/scene/scene_json.h"
#include "ngs/math/sh.h"
#include "ngs/math/stable.h"
#include "ngs/ops/image/image_bytes.h"
#include "ngs/orbit/coverage.h"
#include "ngs/orbit/orbit_stage.h"
#include "ngs/render/background.h"
#include "ngs/render/render_options.h"
#include "ngs/scene/view_names.h"
#include "shared/tool.h"

namespace ngs::scene_tool {
namespace {

namespace fs = std::filesystem;

struct PictureOptions {
  std::string size = "800x800";
  std::string background;
  std::string hold_out;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.size, Text{"size", "WxH", "Size of the pictures in px"});
    visit(self.background, Text{"background", "COLOUR",
                                "Background: black, white or R,G,B in [0, 1]; empty: black or white, whichever "
                                "contrasts more with the model"});
    visit(self.hold_out, Text{"hold_out", "every:N:K|FILE", "Test views, as for ngs-scene import"});
  }
};

orbit::PictureSize parse_size(const std::string& text) {
  const char* const end = text.data() + text.size();
  orbit::PictureSize size;
  const auto [cross, bad_width] = std::from_chars(text.data(), end, size.width_px);
  const bool has_cross = bad_width == std::errc() && cross != end && *cross == 'x';
  const auto [rest, bad_height] = std::from_chars(has_cross ? cross + 1 : end, end, size.height_px);
  constexpr int kMin_px = 16, kMax_px = 16384;
  if (!has_cross || bad_height != std::errc() || rest != end || std::min(size.width_px, size.height_px) < kMin_px ||
      std::max(size.width_px, size.height_px) > kMax_px)
    throw Error(ErrorCode::kUsage, "--size " + text + ": invalid size, expected WxH with sides of 16 to 16384 px",
                "such as --size 1280x960");
  return size;
}

/// Black or white, whichever is farther from the opacity-weighted mean colour of the model.
Vec3<double> contrasting_background(const GaussianCloud& cloud) {
  double sum = 0, total = 0;
  for (std::size_t i = 0; i < std::size_t(cloud.size()); ++i) {
    if (!cloud.usable[i]) continue;
    const double opacity = sigmoid(double(cloud.logit_opacity[i]));
    const float* dc = &cloud.sh_dc[3 * i];
    const double grey = colour_of_dc((double(dc[0]) + double(dc[1]) + double(dc[2])) / 3);
    sum += opacity * std::clamp(grey, 0.0, 1.0);
    total += opacity;
  }
  return sum < 0.5 * total ? Vec3<double>{1, 1, 1} : Vec3<double>{0, 0, 0};
}

constexpr int kSheetQuality = 85;

/// Marker file of a folder with renders of an earlier run, not photos. It lists those that are called like photos.
constexpr const char* kOfRenders = ".ngs-renders";

/// Whether a file is named like a render. Other files in the folder are the user's, such as a painted 0000.jpg.
bool is_render_name(const std::string& name) {
  return name.ends_with(".png") && name.find_first_not_of("0123456789") == name.size() - 4 && name.size() >= 8;
}

/// Output folder of the renders, and its renders of an earlier run.
struct ImagesFolder {
  std::string path;
  std::vector<std::string> earlier;
};

/// The folder images/ next to scene.json. Throws if it contains other files, such as photos, that would be lost.
ImagesFolder images_folder(const std::string& scene_path) {
  const fs::path folder = fs::path(scene_path).parent_path() / "images";
  ImagesFolder images{folder.generic_string(), {}};
  std::error_code ignored;
  if (!fs::exists(folder, ignored)) return images;
  if (!fs::is_directory(folder, ignored))
    throw Error(ErrorCode::kUsage, images.path + ": not a folder, expected a folder for the renders",
                "choose another folder for scene.json");
  if (fs::is_empty(folder, ignored)) return images;
  if (!fs::exists(folder / kOfRenders, ignored))
    throw Error(ErrorCode::kUsage,
                images.path + ": contains files that are not renders of " + scene_path + ", expected none",
                "choose another folder for scene.json");
  const std::vector<std::string> listed = io::read_name_list((folder / kOfRenders).generic_string());
  for (const std::string& name : io::list_images(images.path))
    if (is_render_name(name) || std::ranges::find(listed, name) != listed.end())
      images.earlier.push_back((folder / name).generic_string());
  return images;
}

/// Removes renders of an earlier run that this run did not replace.
void remove_stale(const ImagesFolder& images, const Scene& scene) {
  std::error_code ignored;
  for (const std::string& path : images.earlier)
    if (std::ranges::find(scene.views, path, &SceneView::image_path) == scene.views.end()) fs::remove(path, ignored);
}

Scene scene_of(const orbit::OrbitCameras& chosen, const std::string& model, const std::string& folder) {
  Scene scene;
  scene.model_path = model;
  scene.objects.push_back({});
  scene.world_unit = chosen.world_unit;
  scene.renders = RenderedPhotos{chosen.coverage};
  const auto [width, height] = std::pair(chosen.cameras[0].width_px, chosen.cameras[0].height_px);
  const int shrink = (std::max(width, height) + io::kWorkingSizePx - 1) / io::kWorkingSizePx;
  scene.image_scale = 1.0 / shrink;
  for (const Camera& camera : chosen.cameras)
    scene.views.push_back({resized(camera, scaled_size_px(camera.width_px, scene.image_scale),
                                   scaled_size_px(camera.height_px, scene.image_scale)),
                           (fs::path(folder) / camera.name).generic_string(),
                           {},
                           Split::kTrain});
  return scene;
}

/// The contact sheet, next to scene.json. Throws if a file of this name is not from an earlier run.
std::string sheet_path(const std::string& scene_path, const ImagesFolder& images) {
  std::string path = (fs::path(scene_path).parent_path() / "sheet.jpg").generic_string();
  std::error_code ignored;
  if (images.earlier.empty() && fs::exists(path, ignored))
    throw Error(ErrorCode::kUsage, path + ": exists already, expected a free name for the contact sheet",
                "choose another folder for scene.json");
  return path;
}

/// Renders the scene's views at the size of `cameras` to their image paths. Returns a contact sheet of them.
ContactSheet write_renders(cli::Run& run, const GaussianCloud& cloud, const Scene& scene,
                           const std::vector<Camera>& cameras) {
  const auto timed = run.monitor().scope("render");
  const SplatOptions splat =
      prepared_for(run.exec(), filter_at_scale(splat_options({}, cloud, scene), 1 / scene.image_scale), cloud);
  RenderRequest request{.label = {}, .background = background_of(scene)};
  ContactSheet sheet(cameras.size(), cameras[0].width_px, cameras[0].height_px);
  const std::size_t batch = 4 * std::size_t(run.exec().threads);
  for (std::size_t begin = 0; begin < cameras.size(); begin += batch) {
    std::vector<ImageU8> pictures;
    for (std::size_t v = begin; v < std::min(cameras.size(), begin + batch); ++v) {
      const ImageF colour = render(run.exec(), cloud, cameras[v], splat, request).colour;
      sheet.add(v, colour, cameras[v].name);
      pictures.push_back(to_bytes(colour));
    }
    for_each_task(run.exec(), std::int64_t(pictures.size()), [&](std::int64_t k) {
      io::write_png(scene.views[begin + std::size_t(k)].image_path, pictures[std::size_t(k)]);
    });
    run.monitor().progress(std::int64_t(begin + pictures.size()), std::int64_t(cameras.size()));
  }
  return sheet;
}

/// At most `max_views` cameras of a capture with the names of its photos, evenly chosen, for pictures of at most the
/// longer side of `size`.
std::vector<Camera> cameras_of(const std::string& capture, int max_views, orbit::PictureSize size) {
  io::CaptureRequest request;
  request.source = capture;
  const std::vector<SceneView> views = io::read_capture(request).capture.views;
  const std::vector<std::string> names = output_names(views);
  const std::size_t count = std::min(views.size(), std::size_t(max_views));
  std::vector<Camera> cameras;
  for (std::size_t k = 0; k < count; ++k) {
    const Camera& camera = views[k * views.size() / count].camera;
    const double scale =
        std::min(1.0, double(std::max(size.width_px, size.height_px)) / std::max(camera.width_px, camera.height_px));
    cameras.push_back(resized(camera, scaled_size_px(camera.width_px, scale), scaled_size_px(camera.height_px, scale)));
    cameras.back().name = names[k * views.size() / count] + ".png";
  }
  return cameras;
}

std::string numbers(Vec3<double> v) {
  return formatted("%.4g,", v.x) + formatted("%.4g,", v.y) + formatted("%.4g", v.z);
}

Json chosen_json(const orbit::OrbitCameras& chosen) {
  return {{"photos", kRenderedPhotosNote},
          {"views", chosen.cameras.size()},
          {"place", chosen.inside ? "inside" : "outside"},
          {"centre", {chosen.centre.x, chosen.centre.y, chosen.centre.z}},
          {"radius", chosen.radius},
          {"up", {chosen.up.x, chosen.up.y, chosen.up.z}},
          {"up_is_guessed", chosen.up_is_guessed},
          {"coverage", chosen.coverage},
          {"coverage_views", orbit::kWantedViews},
          {"surface_gaussians", chosen.surface},
          {"candidates", chosen.candidates}};
}

/// Prints the chosen cameras and warns of low coverage.
void print_cameras(cli::Run& run, const OrbitOptions& options, const OrbitOptions& upright,
                   const orbit::OrbitCameras& chosen, bool are_given) {
  const std::string share = formatted("%.1f %%", 100 * chosen.coverage);
  run.text(std::to_string(chosen.cameras.size()) + " cameras " + (chosen.inside ? "inside" : "around") + " the ball " +
           numbers(chosen.centre) + formatted(",%.4g", chosen.radius) + ", up " + numbers(chosen.up) +
           (are_given                     ? " (of the given cameras)"
            : options.up != UpAxis::kAuto ? ""
            : upright.up != UpAxis::kAuto ? " (from the model's comment)"
            : chosen.up_is_guessed        ? " (from a floor)"
                                          : " (no floor found)") +
           "\n" + share + " of the visible surface is visible in at least " + std::to_string(orbit::kWantedViews) +
           " views\n" + "no photos: pictures were rendered from the splat\n");
  if (are_given || chosen.coverage >= options.coverage) return;
  const bool at_limit = std::ssize(chosen.cameras) >= options.max_views;
  run.monitor().warn("coverage " + share + " of the visible surface, expected " +
                     formatted("%.1f %%", 100 * options.coverage) +
                     (at_limit ? ": --max-views " + std::to_string(options.max_views) + " is reached"
                               : ": no other camera position shows more of it"));
}

}  // namespace

int orbit_command(int argc, char** argv) {
  cli::Tool tool("ngs-scene orbit", "Choose cameras for a model without photos and render pictures from them.",
                 {"ngs-scene orbit statue.ply -o statue/scene.json",
                  "ngs-scene orbit hall.compressed.ply --around 1.2,-0.4,3,0.5 --up -y -o guitar/scene.json"});
  OrbitOptions options;
  PictureOptions pictures;
  tool.options(options);
  tool.options(pictures);
  const cli::Input& model = tool.input("model", "3DGS model (.ply, .spz, .sog, .splat, .ksplat, .glb)");
  const cli::Input& cameras = tool.optional_input(
      "--cameras", "cameras.json, COLMAP folder or other poses of the model, instead of chosen cameras");
  const cli::Output& out =
      tool.output("-o,--output", "scene.json; renders go to images/ next to it, all of them to sheet.jpg");

  return tool.run(argc, argv, [&](cli::Run& run) {
    if (run.comes_from_stream(model) || (out && run.goes_to_stdout(out)))
      throw Error(ErrorCode::kUsage,
                  "a stream for MODEL or --output, expected files: scene.json stores the paths of "
                  "model and renders");
    const orbit::PictureSize size = parse_size(pictures.size);
    const ImagesFolder images = out ? images_folder(out.path) : ImagesFolder{"images", {}};
    const std::string sheet = out ? sheet_path(out.path, images) : std::string();
    const io::GaussianPly ply = [&] {
      const auto timed = run.monitor().scope("read");
      return io::read_gaussian_ply(model.path);
    }();
    for (const std::string& note : ply.notes) run.monitor().warn(note);
    OrbitOptions upright = options;
    upright.up = up_or(options.up, ply.vertical_axis);
    const orbit::OrbitCameras chosen = with_context(model.path, [&] {
      if (cameras)
        return orbit::assess_cameras(run.exec(), run.monitor(), ply.cloud, options,
                                     cameras_of(cameras.path, options.max_views, size));
      return orbit::choose_cameras(run.exec(), run.monitor(), ply.cloud, upright, size);
    });
    Scene scene = scene_of(chosen, model.path, images.path);
    choose_background(pictures.background, run.monitor(), scene);
    if (!scene.background) scene.background = contrasting_background(ply.cloud);
    io::assign_splits(pictures.hold_out, scene.views);
    run.result() = chosen_json(chosen);
    run.result()["model"] = health_json(ply.health);
    print_cameras(run, options, upright, chosen, bool(cameras));
    if (run.dry_run()) {
      run.plan({{"views", scene.views.size()}});
      return cli::kDone;
    }
    fs::create_directories(images.path);
    std::string names;
    for (const Camera& camera : chosen.cameras)
      if (!is_render_name(camera.name)) names += camera.name + "\n";
    io::write_file((fs::path(images.path) / kOfRenders).generic_string(), names);
    const ContactSheet drawn = write_renders(run, ply.cloud, scene, chosen.cameras);
    const std::vector<std::uint8_t> jpeg = io::encode_jpeg(drawn.picture(), kSheetQuality);
    io::write_file(sheet, std::string(jpeg.begin(), jpeg.end()));
    remove_stale(images, scene);
    io::write_scene_json(out.path, scene);
    return cli::kDone;
  });
}

}  // namespace ngs::scene_tool
