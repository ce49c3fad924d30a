#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>

#include "commands.h"
#include "cut_inputs.h"
#include "ngs/core/formatted.h"
#include "ngs/core/listed.h"
#include "ngs/io/files/mapped_file.h"
#include "ngs/io/formats/splat_format.h"
#include "ngs/io/ply/gaussian_columns.h"
#include "ngs/io/ply/gaussian_ply.h"
#include "ngs/io/scene/import_scene.h"
#include "ngs/io/scene/scene_json.h"
#include "ngs/orbit/orbit_stage.h"
#include "ngs/scene/geometry/frame.h"
#include "ngs/scene/geometry/surface_points.h"
#include "ngs/scene/mask_threshold.h"
#include "ngs/scene/supersplat_state.h"
#include "shared/run/child_process.h"
#include "shared/text/layout.h"
#include "shared/tool.h"

namespace ngs::ngs_tool {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kListedNames = 6;

/// The lines of the text, and the same facts as JSON.
class Facts {
 public:
  explicit Facts(Json& json) : json_(json) {}
  void add(const std::string& name, const std::string& text, const std::string& key, Json value) {
    text_ += cli::padded(name, 12) + text + "\n";
    json_[key] = std::move(value);
  }
  void add_next(const std::vector<std::string>& command) {
    const std::string line = cli::quoted_line(command);
    json_["next"] = line;
    next_ = cli::padded("next", 12) + line + "\n";
  }
  void print(cli::Run& run) const {
    run.needed(text_);
    run.verbatim(next_);
  }

 private:
  Json& json_;
  std::string text_, next_;
};

std::string share_text(std::size_t count, std::size_t all, const std::string& what) {
  return std::to_string(count) + " of " + std::to_string(all) + " " + what;
}

std::string triple(const std::array<double, 3>& v) {
  return formatted("%.6g ", v[0]) + formatted("%.6g ", v[1]) + formatted("%.6g", v[2]);
}

std::string format_name(const std::string& path, const io::GaussianPly& ply) {
  const io::MappedFile file = io::map_regular_file(path);
  switch (io::input_format(path, file.bytes())) {
    case io::SplatFormat::kSpz: return ".spz";
    case io::SplatFormat::kSog: return ".sog";
    case io::SplatFormat::kSplat: return ".splat";
    case io::SplatFormat::kKsplat: return ".ksplat";
    case io::SplatFormat::kGlb: return ".glb";
    default: break;
  }
  return io::is_compressed(ply.file) ? "PLY, compressed (SuperSplat)" : "PLY";
}

/// World, of usable Gaussians.
struct Box {
  std::array<double, 3> low, high;
};

Box box_of(const GaussianCloud& cloud) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  Box box{{kFar, kFar, kFar}, {-kFar, -kFar, -kFar}};
  for (std::size_t i = 0; i < std::size_t(cloud.size()); ++i) {
    if (!cloud.usable[i]) continue;
    const Vec3<double> p = world_position(cloud, i);
    const double xyz[] = {p.x, p.y, p.z};
    for (std::size_t a = 0; a < 3; ++a) {
      box.low[a] = std::min(box.low[a], xyz[a]);
      box.high[a] = std::max(box.high[a], xyz[a]);
    }
  }
  return box;
}

void add_place(const io::GaussianPly& ply, const orbit::Ball& bulk, Facts& facts) {
  constexpr double kGeoreferenced = 1e5;  // world; coordinates of surveys are in metres
  const Box box = box_of(ply.cloud);
  facts.add("box", triple(box.low) + " to " + triple(box.high), "box", {{"low", box.low}, {"high", box.high}});
  const std::array<double, 3>& o = ply.cloud.origin;
  const std::array<double, 3> centre{bulk.centre.x + o[0], bulk.centre.y + o[1], bulk.centre.z + o[2]};
  facts.add("bulk", "most of it within " + formatted("%.4g", bulk.radius) + " of " + triple(centre), "bulk",
            {{"centre", centre}, {"radius", bulk.radius}});
  const bool is_surveyed = std::ranges::any_of(centre, [](double x) { return std::abs(x) > kGeoreferenced; });
  facts.add("unit", is_surveyed ? "metres, by coordinates as of a survey" : "not stored; of photos without a scale any",
            "unit", is_surveyed ? Json("metres") : Json());
}

void add_up(const io::GaussianPly& ply, const orbit::SurfacePoints& points, const orbit::Ball& bulk, Facts& facts) {
  const orbit::UpGuess floor = orbit::guess_up(points, bulk);
  std::string why = floor.found ? "by a floor or its base" : "no floor found: usual for models of photos";
  Vec3<double> up = floor.up;
  if (const UpAxis axis = up_or(UpAxis::kAuto, ply.vertical_axis); axis != UpAxis::kAuto) {
    why = "comment of the file";
    up = orbit::axis_of(axis);
  }
  facts.add("up", triple({up.x, up.y, up.z}) + " (" + why + ")", "up", {{"axis", {up.x, up.y, up.z}}, {"why", why}});
}

void add_columns(const io::GaussianPly& ply, Facts& facts) {
  std::vector<std::string> columns = io::further_columns(ply), moving;
  std::ranges::copy_if(columns, std::back_inserter(moving), &io::is_motion_column);
  std::erase_if(columns, &io::is_motion_column);
  if (!moving.empty())
    facts.add("moves", listed(moving, kListedNames) + ": a 4D splat, read at its reference time", "motion_columns",
              moving);
  if (!columns.empty()) facts.add("columns", listed(columns, kListedNames) + ": of other programs", "columns", columns);
  const auto with = [&](std::uint8_t bit) {
    return std::ranges::count_if(ply.state, [&](std::uint8_t state) { return (state & bit) != 0; });
  };
  if (!ply.state.empty())
    facts.add("state",
              std::to_string(with(kSelectedState)) + " selected, " + std::to_string(with(kDeletedState)) +
                  " deleted (SuperSplat); still used here",
              "state", {{"selected", with(kSelectedState)}, {"deleted", with(kDeletedState)}});
}

/// Objects with their counts. Returns whether there are labels.
bool add_objects(const io::GaussianPly& ply, Facts& facts) {
  Json json = Json::array();
  std::vector<std::string> names;
  const auto add = [&](const std::string& name, const LabelColumns& labels) {
    const auto count = std::ranges::count_if(labels.label.values(), [](float v) { return is_set(v); });
    names.push_back(name + " " + std::to_string(count));
    json.push_back({{"name", name}, {"gaussians", count}});
  };
  for (const io::NamedLabels& object : ply.objects) add(object.object, object.columns);
  if (ply.objects.empty() && !ply.labels.label.empty()) add(ply.object, ply.labels);
  if (names.empty()) return false;
  facts.add("objects", listed(names, kListedNames), "objects", json);
  return true;
}

void add_debris(const GaussianCloud& cloud, const orbit::SurfacePoints& points, const orbit::Ball& bulk, Facts& facts) {
  constexpr double kFar = 10;  // radii of the bulk
  const auto far = std::ranges::count_if(
      points.position, [&](const orbit::Vec& p) { return length(p - bulk.centre) > kFar * bulk.radius; });
  const std::int64_t faint = std::ranges::count(cloud.usable, 1) - std::int64_t(points.count());
  facts.add("debris",
            std::to_string(far) + " far away (floaters or sky), " + std::to_string(faint) + " too faint to be drawn",
            "debris", {{"far", far}, {"faint", faint}});
}

void describe_splat(const std::string& path, Facts& facts) {
  const io::GaussianPly ply = io::read_gaussian_ply(path);
  const GaussianCloud& cloud = ply.cloud;
  const std::string format = format_name(path, ply);
  facts.add("format", format + formatted(", %.0f bytes", double(fs::file_size(path))), "format", format);
  const std::int64_t ignored = ply.health.excluded();
  facts.add("Gaussians",
            std::to_string(cloud.size()) +
                (ignored > 0 ? ", " + std::to_string(ignored) + " of them ignored: not finite or absurdly large" : ""),
            "gaussians", cloud.size());
  facts.add("colours",
            "SH of degree " + std::to_string(cloud.sh_degree) +
                (cloud.antialiased ? ", trained with antialiasing" : ", no tag of antialiasing"),
            "sh_degree", cloud.sh_degree);
  facts.add("not finite", std::to_string(ply.health.non_finite), "non_finite", ply.health.non_finite);
  if (const orbit::SurfacePoints points = orbit::surface_points(cloud); points.count() > 0) {
    const orbit::Ball bulk = orbit::bulk_of(points);
    add_place(ply, bulk, facts);
    add_up(ply, points, bulk, facts);
    add_debris(cloud, points, bulk, facts);
  }
  add_columns(ply, facts);
  if (!ply.notes.empty()) facts.add("notes", listed(ply.notes, kListedNames), "notes", ply.notes);
  if (add_objects(ply, facts))
    facts.add_next({"ngs-extract", path, "--object-ply", "object.ply", "--background-ply", "background.ply"});
  else
    facts.add_next({"ngs", "cut", path});
}

/// The views of a scene, of which some have photos and masks. Returns whether some have masks.
bool add_views(const Scene& scene, Facts& facts) {
  const std::size_t all = scene.views.size();
  const auto with = [&](auto member) {
    return all - std::size_t(std::ranges::count(scene.views, std::string(), member));
  };
  const std::size_t photos = with(&SceneView::image_path), masks = with(&SceneView::mask_path);
  const auto held_out = std::size_t(std::ranges::count(scene.views, Split::kHeldOut, &SceneView::split));
  const Camera& first = scene.views.front().camera;
  const std::string size = std::to_string(first.width_px) + "x" + std::to_string(first.height_px) + " px";
  facts.add("views", std::to_string(all) + ", the first of " + size + ", " + std::to_string(held_out) + " held out",
            "views", all);
  facts.add("photos", share_text(photos, all, scene.renders ? "views, renders of the model" : "views"), "photos",
            photos);
  facts.add("masks", share_text(masks, all, "views"), "masked_views", masks);
  std::vector<std::string> names;
  for (const SceneObject& object : scene.objects) names.push_back(object.name);
  facts.add("objects", listed(names, kListedNames), "objects", names);
  facts.add("splat", scene.model_path.empty() ? "none" : scene.model_path, "model", scene.model_path);
  return masks > 0;
}

void describe_scene(const std::string& path, Facts& facts) {
  const Scene scene = io::read_scene_json(path);
  facts.add("format", "scene.json, as ngs-scene writes it", "format", "scene.json");
  const bool has_masks = add_views(scene, facts);
  if (has_masks || !scene.renders)
    facts.add_next({"ngs", "cut", path});
  else
    facts.add_next({"ngs", "cut", path, "--strokes", "FILE"});
}

void describe_capture(const std::string& path, Facts& facts) {
  io::ImportRequest request;
  request.capture.source = path;
  const io::ImportedScene imported = io::import_scene(request);
  facts.add("format", "capture, cameras by " + imported.format + ": " + imported.cameras_file, "format",
            imported.format);
  add_views(imported.scene, facts);
  if (!imported.notes.empty()) facts.add("notes", listed(imported.notes, kListedNames), "notes", imported.notes);
  if (imported.scene.model_path.empty())
    facts.add_next({"ngs", "cut", path, "--model", "FILE.ply"});
  else
    facts.add_next({"ngs", "cut", path});
}

}  // namespace

int info_command(int argc, char** argv) {
  cli::Tool tool("ngs info", "Say what a file is: a splat in any format, a scene.json or the folder of a capture.",
                 {"ngs info statue.ply", "ngs statue.spz  # the same", "ngs info captures/garden --json"});
  const cli::Argument& source = tool.argument(
      "source", "a splat (.ply, .spz, .sog, .splat, .ksplat, .glb), a scene.json or the folder of a capture");
  tool.reports_on_request();

  return tool.run(argc, argv, [&](cli::Run& run) {
    const std::string path = source.value;
    const SourceKind kind = kind_of(path);
    if (fs::is_regular_file(path)) run.add_input("source", path);
    if (run.dry_run()) {
      run.plan({{"source", path}});
      return cli::kDone;
    }
    Facts facts(run.result());
    facts.add("file", path, "file", path);
    if (kind == SourceKind::kSplat) describe_splat(path, facts);
    const std::string result = (fs::path(path) / "scene.json").string();  // of a folder that ngs cut wrote
    const bool is_result = kind == SourceKind::kCapture && fs::exists(result) && kind_of(result) == SourceKind::kScene;
    if (kind == SourceKind::kScene || is_result) describe_scene(is_result ? result : path, facts);
    if (kind == SourceKind::kCapture && !is_result) describe_capture(path, facts);
    facts.print(run);
    return cli::kDone;
  });
}

}  // namespace ngs::ngs_tool
