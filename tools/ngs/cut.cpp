#include <algorithm>
#include <filesystem>
#include <optional>
#include <set>
#include <string>

#include "commands.h"
#include "cut_chain.h"
#include "cut_inputs.h"
#include "cut_summary.h"
#include "ngs/core/error.h"
#include "ngs/io/files/atomic_file.h"
#include "ngs/io/files/folder_index.h"
#include "ngs/io/files/shell_word.h"
#include "ngs/io/formats/write_splat.h"
#include "ngs/io/scene/scene_json.h"
#include "ngs/mesh/collider/collider.h"
#include "ngs/orbit/orbit_stage.h"
#include "shared/run/paths.h"
#include "shared/run/run.h"
#include "shared/tool.h"

namespace ngs::ngs_tool {
namespace {

namespace fs = std::filesystem;

/// Throws kUsage for a format that is not written.
void check_formats(const CutOptions& options) {
  for (const std::string& format : options.format)
    if (io::output_format("object." + format) == io::SplatFormat::kPly)
      throw Error(ErrorCode::kUsage, "--format " + format + ": unknown, expected one of " + io::kOutputFormats,
                  "such as --format sog; a PLY is always written");
}

/// Writes object.EXT and background.EXT of the PLYs in `folder`, by --up and --unit.
void write_other_formats(cli::Run& run, const CutOptions& options, const std::string& folder) {
  if (options.format.empty()) return;
  std::optional<Vec3<double>> up;
  if (options.up != UpAxis::kAuto) up = orbit::axis_of(options.up);
  for (const std::string half : {"object", "background"}) {
    const std::string path = folder + "/" + half + ".";
    const io::GaussianPly ply = io::read_gaussian_ply(path + "ply");
    for (const std::string& format : options.format)
      for (const std::string& note : io::write_splat(path + format, {ply, {}, nullptr, up, options.unit}))
        run.monitor().warn(note);
  }
}

constexpr const char* kMarker = ".ngs-cut";  // marks a folder written by ngs cut

/// Default output: "statue-cut" for "statue.ply", "garden-cut" for "garden/", in the current folder. If the current
/// folder is inside the source, next to the source: "../garden-cut" for "." in garden.
std::string default_folder(const std::string& source) {
  const fs::path path = (fs::absolute(source) / "").lexically_normal().parent_path(), here = fs::current_path();
  fs::path name = path.filename();
  if (!fs::is_directory(path)) {
    if (name.extension() == ".gz") name = name.stem();
    name = name.stem();
    if (name.extension() == ".compressed") name = name.stem();
  }
  if (name.empty()) name = "ngs";
  name += "-cut";
  const bool is_around = std::mismatch(path.begin(), path.end(), here.begin(), here.end()).first == path.end();
  return (is_around ? (path.parent_path() / name).lexically_relative(here) : name).generic_string();
}

/// Throws kUsage if the folder has files that are not from an earlier run.
void require_own_folder(const std::string& folder, bool overwrite) {
  std::error_code absent;
  io::require_readable_folder(folder);
  if (!fs::exists(folder, absent) || fs::is_empty(folder, absent) || fs::exists(fs::path(folder) / kMarker, absent))
    return;
  if (!overwrite)
    throw Error(ErrorCode::kUsage, folder + ": contains files that are not from an earlier run of ngs cut",
                "choose another folder with -o, or use this one with -w");
}

/// Throws kUsage if the results would replace inputs: the folder is the capture, or its masks/ are given ones.
void require_other_folder(const CutInputs& inputs) {
  const auto are_same = [](const std::string& a, const std::string& b) {
    std::error_code absent;
    return !a.empty() && fs::equivalent(a, b, absent);
  };
  const std::string& out = inputs.out;
  if ((inputs.kind == SourceKind::kCapture && are_same(inputs.source, out)) || are_same(inputs.masks, out + "/masks") ||
      are_same(inputs.truth, out + "/masks"))
    throw Error(ErrorCode::kUsage, out + ": the results would replace inputs in this folder, expected another one",
                "choose another folder with -o");
}

/// Removes the folder of a failed run if it contains nothing useful: the first stage failed, or only the import of a
/// capture did not.
void remove_useless_folder(const CutChain& chain) {
  std::error_code ignored;
  const std::size_t useless = chain.inputs().kind == SourceKind::kCapture ? 1 : 0;  // stages
  if (chain.stages().results().size() <= useless) fs::remove_all(chain.inputs().out, ignored);
}

/// A path that no tool takes for an option: "./-photos" for "-photos".
std::string operand(const std::string& path) { return path.starts_with("-") ? "./" + path : path; }

std::vector<std::string> operands(std::vector<std::string> paths) {
  for (std::string& path : paths) path = operand(path);
  return paths;
}

constexpr const char* kCaptureGroup = "capture";

/// Flags that hints of stages may mention without the name of a tool.
std::set<std::string> own_flags(const OptionSet& options) {
  std::set<std::string> flags{"--model",   "--ply",    "--masks",     "--images",      "--world-transform", "--gt",
                              "--strokes", "--output", "--overwrite", "--allow-empty", "--dry-run",         "--device"};
  for (const OptionEntry& entry : options.entries()) flags.insert(option_flag(entry.name));
  return flags;
}

/// The flags of the capture group, for warnings.
std::vector<std::string> capture_flags(const OptionSet& options) {
  std::vector<std::string> flags{"--images", "--world-transform"};
  for (const OptionEntry& entry : options.entries())
    if (entry.group->name == kCaptureGroup) flags.push_back(option_flag(entry.name));
  return flags;
}

/// The given options, or those of one group, as command line arguments.
Words given_words(const OptionSet& options, const std::string& group = {}) {
  Words words;
  for (const OptionEntry* entry : options.changed()) {
    if (!group.empty() && entry->group->name != group) continue;
    const std::string flag = option_flag(entry->name);
    const Json value = entry->get();
    if (value.is_boolean())
      words.push_back(value.get<bool>() ? flag : "--no-" + flag.substr(2));
    else
      for (const Json& one : value.is_array() ? value : Json::array({value})) {
        words.push_back(flag);
        words.push_back(one.is_string() ? one.get<std::string>() : one.dump());
      }
  }
  return words;
}

void check_flash(bool has_renders, bool has_masks) {
  if (has_renders && !has_masks) return;
  throw Error(ErrorCode::kUsage,
              std::string("--method flash with ") + (has_masks ? "masks" : "photos") +
                  ": it uses renders of the splat only, expected a splat and strokes",
              "choose --quality draft");
}

int tell_plan(cli::Run& run, const CutChain& chain, CutEnd end) {
  const StageRunner& stages = chain.stages();
  std::string text = plan_text(stages.steps(), chain.inputs().out);
  if (end == CutEnd::kNeedsStrokes) text += "then it stops, because nothing is marked yet\n";
  run.text(text + chain.strokes_found());
  std::string commands = "commands:\n";
  for (const std::string& command : stages.commands()) commands += "  " + command + "\n";
  run.verbatim(commands);
  Json steps = Json::array();
  for (const PlannedStep& step : stages.steps())
    steps.push_back({{"step", step.about}, {"tool", tool_of(step)}, {"files", step.files}});
  run.plan({{"steps", std::move(steps)}, {"commands", stages.commands()}});
  return cli::kDone;
}

/// The scene at `path` if its images are renders of its splat.
std::optional<Scene> scene_of_renders(SourceKind kind, const std::string& path) {
  if (kind != SourceKind::kScene) return {};
  Scene scene = io::read_scene_json(path);
  return scene.renders ? std::optional(std::move(scene)) : std::nullopt;
}

/// Warns about options that have no effect on this kind of source.
void warn_unused_options(cli::Run& run, cli::Tool& tool, SourceKind kind, bool has_renders, bool renders_capture) {
  if (kind != SourceKind::kSplat) run.warn_unused({"--size", "--view-count"}, "except for a splat without photos");
  if (!has_renders) run.warn_unused({"--around"}, "except for a splat without photos");
  if (kind != SourceKind::kCapture) {
    run.warn_unused({"--image-scale"}, "except for a capture");
    run.warn_unused(capture_flags(tool.option_set()), "except for a capture");
  }
  if (kind == SourceKind::kSplat && !renders_capture) run.warn_unused({"--model"}, "with a splat");
  if (kind == SourceKind::kScene) run.warn_unused({"--hold-out"}, "with a scene.json, which has its own split");
}

/// The splat of a capture without photos, whose pictures are rendered at its cameras; empty: there are photos or masks.
/// kInconsistent with options that describe a capture.
std::string bare_splat_of(cli::Run& run, const std::string& capture, const std::string& model, bool marked,
                          bool has_capture_options) {
  std::string splat = splat_without_photos(capture, model, marked);
  if (splat.empty()) return splat;
  if (has_capture_options)
    throw Error(ErrorCode::kInconsistent, capture + ": no photo of any view, expected photos or masks",
                "name their folder with --images DIR; for the splat alone: ngs cut " + io::shell_word(splat));
  run.monitor().warn(capture + ": no photos: pictures are rendered from " + splat +
                     " at its cameras (if there are photos: --images DIR)");
  return splat;
}

void check_options(cli::Run& run, const CutOptions& options, const CutInputs& inputs) {
  if (!inputs.strokes.empty() && !inputs.masks.empty())
    throw Error(ErrorCode::kUsage, "--strokes and --masks are both given, expected one of them");
  check_formats(options);
  if (!options.collider.empty()) mesh::collider_choice(options.collider);
  if (!options.mesh) run.warn_unused({"--collider"}, "without --mesh");
  if (options.all || (!options.mesh && options.format.empty())) {
    run.warn_unused({"--unit"}, "without --mesh or --format");
    if (inputs.renders_capture || inputs.kind != SourceKind::kSplat)
      run.warn_unused({"--up"}, "except for a splat without photos or cameras, --mesh and --format");
  }
  if (options.all) {
    if (!inputs.strokes.empty())
      throw Error(ErrorCode::kUsage,
                  "--all with --strokes: strokes mark one object, expected masks of everything or none",
                  "leave out one of the two");
    run.warn_unused({"--mesh", "--format", "--fill", "--all-pieces", "--force", "--view", "--gt"}, "with --all");
  }
  if (options.method == CutMethod::kFlash && !options.all)
    check_flash(inputs.has_renders, !inputs.masks.empty() || !inputs.truth.empty());
}

/// With --all alone: the capture's masks_everything/ (docs/formats.md), as if --masks named it.
void find_masks_of_everything(cli::Run& run, const CutOptions& options, CutInputs& inputs) {
  const std::string folder = inputs.source + "/masks_everything";
  if (!options.all || inputs.kind != SourceKind::kCapture || !inputs.masks.empty() || !fs::is_directory(folder)) return;
  run.monitor().warn(folder + ": used as masks of everything (others: --masks DIR)");
  inputs.masks = folder;
  inputs.given_masks = folder;
}

int cut(cli::Run& run, const CutOptions& options, CutInputs inputs) {
  find_masks_of_everything(run, options, inputs);
  check_options(run, options, inputs);
  require_other_folder(inputs);
  if (fs::is_regular_file(inputs.source)) run.add_input("source", inputs.source);
  const bool makes_folder = !run.dry_run() && !exists(inputs.out);
  std::optional<cli::FolderLock> lock;
  if (!run.dry_run()) {
    std::error_code failed, absent;
    fs::create_directories(inputs.out, failed);
    if (const fs::path to = fs::read_symlink(inputs.out, absent); failed && !to.empty())
      throw Error(ErrorCode::kEnvironment, inputs.out + ": a link to " + to.string() + ", which is not there",
                  "remove the link: rm " + io::shell_word(inputs.out) + "; or choose another folder: -o DIR");
    if (failed)
      throw Error(ErrorCode::kEnvironment, inputs.out + ": cannot be created: " + failed.message(),
                  "choose a folder that you can write to: -o DIR");
    lock.emplace(inputs.out);
    require_own_folder(inputs.out, run.overwrite());
    for (const char* of_earlier_run : {"/mesh.glb", "/reports/ngs-mesh.json", "/reports/ngs-mesh.sh"})
      fs::remove(inputs.out + of_earlier_run, absent);  // the page would show it
    io::write_file(inputs.out + "/" + kMarker, "a folder of ngs cut\n");
  }
  CutChain chain(run, options, std::move(inputs));
  const CutEnd end = [&] {
    try {
      return chain.run();
    } catch (...) {
      if (makes_folder) remove_useless_folder(chain);
      throw;
    }
  }();
  if (run.dry_run()) return tell_plan(run, chain, end);
  if (end == CutEnd::kStopped) {
    run.text(stopped_text(chain));
    run.verbatim(next_line(chain, {}));
    return run.stop_code();
  }
  run.result()["out"] = chain.inputs().out;
  if (end == CutEnd::kNeedsStrokes) {
    run.result()["needs_strokes"] = true;
    const StrokeHelp help = stroke_help(chain);
    run.text(help.text);
    run.verbatim(help.sample);
    run.verbatim(next_line(chain, {"--strokes", "FILE"}));
    return cli::kDone;
  }
  if (options.all) {
    run.result().update(all_json(chain));
    run.text(all_text(chain));
    return cli::kDone;
  }
  write_other_formats(run, options, chain.inputs().out);
  run.result().update(summary_json(chain));
  run.text(summary_of(chain));
  return cli::kDone;
}

constexpr const char* kSourceText =
    "a splat (.ply, .spz, .sog, .splat, .ksplat, .glb), a folder of photos, poses, a splat and masks, or a scene.json";

bool sets_quality(const OptionSet& options) {
  return std::ranges::any_of(options.changed(), [](const OptionEntry* entry) { return entry->name == "quality"; });
}

}  // namespace

int cut_command(int argc, char** argv) {
  cli::Tool tool("ngs cut", "Cut an object out of a splat, a capture or a scene: the whole chain in one command.",
                 {"ngs cut statue.ply                      # renders it and explains how to mark the object",
                  "ngs cut statue.ply --strokes strokes.json", "ngs cut captures/garden --hold-out every:8:0 -o garden",
                  "ngs cut room.ply --all                   # every object of a room",
                  "ngs cut captures/room --all --masks captures/room/masks_all"});
  CutOptions options;
  CaptureOptions of_capture;
  tool.options(options);
  tool.options(of_capture, {.name = kCaptureGroup,
                            .about = "how cameras, photos and masks are read, as in ngs-scene import",
                            .shown = Shown::kByName});
  const cli::Argument& source = tool.argument("source", kSourceText);
  const cli::Inputs& strokes = tool.inputs(
      "--strokes", "marked copies of pictures or JSON files, or a folder of them (repeatable, or PATH,PATH)");
  const cli::Input& model =
      tool.optional_input("--model", "the splat, if the capture or scene has none or another one", "--ply");
  const cli::Input& masks = tool.optional_input("--masks", "folder of masks named like the images, instead of strokes");
  const cli::Input& images = tool.optional_input("--images", "capture: folder of photos; default: its images/");
  const cli::Input& world =
      tool.optional_input("--world-transform", "capture: JSON {transform, scale}, as for ngs-scene import");
  const cli::Input& truth = tool.optional_input("--gt", "folder of true masks, to score the result");
  const cli::Output& out = tool.resumed_output_dir("-o,--output", "folder for all outputs; default: SOURCE-cut");
  tool.stops_on_request();
  tool.runs_on_device();
  tool.reports_on_request();

  return tool.run(argc, argv, [&](cli::Run& run) {
    std::string bare_splat;
    SourceKind kind = kind_of(source.value);
    if (kind == SourceKind::kCapture && !masks && !images)
      bare_splat = bare_splat_of(run, source.value, model.path, bool(strokes),
                                 world || !given_words(tool.option_set(), kCaptureGroup).empty());
    if (!bare_splat.empty()) kind = SourceKind::kSplat;
    const std::optional<Scene> renders = scene_of_renders(kind, source.value);
    const bool has_renders = kind == SourceKind::kSplat || renders;
    warn_unused_options(run, tool, kind, has_renders, !bare_splat.empty());
    return cut(run, options,
               {.source = operand(source.value),
                .kind = kind,
                .strokes = operands(strokes.paths),
                .model = operand(model     ? model.path
                                 : renders ? renders->model_path
                                           : bare_splat),
                .masks = operand(masks.path),
                .truth = operand(truth.path),
                .given_masks = operand(masks.path),
                .given_truth = operand(truth.path),
                .images = operand(images.path),
                .world_transform = operand(world.path),
                .import_words = given_words(tool.option_set(), kCaptureGroup),
                .all_words = given_words(tool.option_set()),
                .own_flags = own_flags(tool.option_set()),
                .out = operand(out ? out.path : default_folder(source.value)),
                .trains_all = sets_quality(tool.option_set()),
                .has_renders = has_renders,
                .renders_capture = !bare_splat.empty()});
  });
}

}  // namespace ngs::ngs_tool
