#include "cut.h"

#include <algorithm>
#include <filesystem>
#include <set>

#include "cut_chain.h"
#include "cut_summary.h"
#include "ngs/core/error.h"
#include "ngs/io/files/atomic_file.h"
#include "shared/tool.h"

namespace ngs::front {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMarker = ".ngs-cut";  // in a folder that is ours

/// "statue.ply" -> "statue-cut", "garden/" -> "garden-cut", in the current folder; beside a source that the current
/// folder lies in: of ".", in garden, "../garden-cut".
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
  return (is_around ? (path.parent_path() / name).lexically_relative(here) : name).string();
}

/// A folder that holds something else than an earlier run's would be mixed with it.
void require_own_folder(const std::string& folder, bool overwrite) {
  std::error_code absent;
  if (!fs::exists(folder, absent) || fs::is_empty(folder, absent) || fs::exists(fs::path(folder) / kMarker, absent))
    return;
  if (!overwrite)
    throw Error(ErrorCode::kUsage, folder + ": holds files that no earlier run of this command made",
                "choose another folder with -o, or write into it with -w");
}

/// Made by this run, and gone again where its first stage fails: nothing in it is of any use.
class NewFolder {
 public:
  NewFolder(std::string path, bool is_new) : path_(std::move(path)), is_new_(is_new) {}
  void remove_after_failure(const CutChain& chain) const {
    std::error_code ignored;
    if (is_new_ && chain.stages().results().empty()) fs::remove_all(path_, ignored);
  }

 private:
  std::string path_;
  bool is_new_;
};

constexpr const char* kCaptureGroup = "capture";

/// Those that a hint of a stage may name as they are.
std::set<std::string> own_flags(const OptionSet& options) {
  std::set<std::string> flags{"--model",   "--ply",    "--masks",     "--images",      "--world-transform", "--gt",
                              "--strokes", "--output", "--overwrite", "--allow-empty", "--dry-run"};
  for (const OptionEntry& entry : options.entries()) flags.insert(option_flag(entry.name));
  return flags;
}

/// The flags of the group, for messages.
std::vector<std::string> capture_flags(const OptionSet& options) {
  std::vector<std::string> flags{"--images", "--world-transform"};
  for (const OptionEntry& entry : options.entries())
    if (entry.group->name == kCaptureGroup) flags.push_back(option_flag(entry.name));
  return flags;
}

/// What was given of the options, or of the group alone, as words of a command line.
Words given_words(const OptionSet& options, const std::string& group = {}) {
  Words words;
  for (const OptionEntry* entry : options.given()) {
    if (!group.empty() && entry->group->name != group) continue;
    const std::string flag = option_flag(entry->name);
    const Json value = entry->get();
    if (value.is_boolean())
      words.push_back(value.get<bool>() ? flag : "--no-" + flag.substr(2));
    else
      for (const Json& one : value.is_array() ? value : Json::array({value}))
        words.push_back(flag), words.push_back(one.is_string() ? one.get<std::string>() : one.dump());
  }
  return words;
}

void check_flash(SourceKind kind, bool has_masks) {
  if (kind == SourceKind::kSplat && !has_masks) return;
  throw Error(ErrorCode::kUsage,
              std::string("--quality flash with ") + (has_masks ? "masks" : "photos") +
                  ": it looks at the splat's own pictures alone, expected a splat and strokes",
              "choose --quality draft");
}

int cut(cli::Run& run, const CutOptions& options, CutInputs inputs) {
  const NewFolder folder(inputs.out, !run.dry_run() && !fs::exists(inputs.out));
  if (!run.dry_run()) {
    require_own_folder(inputs.out, run.overwrite());
    fs::create_directories(inputs.out);
    io::write_file(inputs.out + "/" + kMarker, "a folder of ngs cut\n");
  }
  CutChain chain(run, options, std::move(inputs));
  const CutEnd end = [&] {
    try {
      return chain.run();
    } catch (...) {
      folder.remove_after_failure(chain);
      throw;
    }
  }();
  if (run.dry_run()) {
    std::string plan = "it would run:\n";
    for (const std::string& command : chain.stages().commands()) plan += "  " + command + "\n";
    run.text(plan);
    run.plan({{"commands", chain.stages().commands()}});
    return cli::kDone;
  }
  if (end == CutEnd::kStopped) {
    run.text("stopped; " + chain.inputs().out + " keeps what was finished: run the same command again to go on\n");
    return run.stop_code();
  }
  run.result()["out"] = chain.inputs().out;
  if (end == CutEnd::kNeedsStrokes) {
    run.result()["needs_strokes"] = true;
    run.text(stroke_help(chain));
    return cli::kDone;
  }
  run.result().update(summary_json(chain));
  run.text(summary_of(chain));
  return cli::kDone;
}

}  // namespace

int cut_command(int argc, char** argv) {
  cli::Tool tool(
      "ngs cut", "Cut an object out of a splat, a capture or a scene: the whole chain in one command.",
      {"ngs cut statue.ply                      # makes pictures of it, says how to mark the object",
       "ngs cut statue.ply --strokes strokes.json", "ngs cut captures/garden --hold-out every:8:0 -o garden"});
  CutOptions options;
  CaptureOptions of_capture;
  tool.options(options);
  tool.options(of_capture, {.name = kCaptureGroup,
                            .about = "how cameras, photos and masks are read: those of ngs-scene import",
                            .shown = Shown::kByName});
  const cli::Argument& source =
      tool.argument("source",
                    "a splat (.ply, .spz, .sog, .splat, .ksplat), a folder of photos, poses, a splat and masks, "
                    "or a scene.json");
  const cli::Inputs& strokes = tool.inputs(
      "--strokes", "marks on one or more views, as ngs-mask --prompts takes them (repeatable, or PATH,PATH)");
  const cli::Input& model =
      tool.optional_input("--model", "the splat, where a capture or scene names none or another", "--ply");
  const cli::Input& masks =
      tool.optional_input("--masks", "folder of masks by the pictures' names, in place of strokes");
  const cli::Input& images = tool.optional_input("--images", "a capture: folder of photos; else images/ in it");
  const cli::Input& world =
      tool.optional_input("--world-transform", "a capture: JSON {transform, scale}, as ngs-scene import takes it");
  const cli::Input& truth = tool.optional_input("--gt", "folder of true masks, to score the result");
  const cli::Output& out = tool.resumed_output_dir("-o,--output", "folder for all that is made; default: SOURCE-cut");
  tool.stops_on_request();

  return tool.run(argc, argv, [&](cli::Run& run) {
    if (strokes && masks) throw Error(ErrorCode::kUsage, "--strokes and --masks are both given, expected one of them");
    const SourceKind kind = kind_of(source.value);
    if (options.quality == CutQuality::kFlash) check_flash(kind, masks || truth);
    if (kind != SourceKind::kSplat) run.warn_unused({"--around", "--up", "--size", "--views"}, "but for a splat alone");
    if (kind != SourceKind::kCapture) {
      run.warn_unused({"--image-scale"}, "but for a capture");
      run.warn_unused(capture_flags(tool.option_set()), "but for a capture");
    }
    if (kind == SourceKind::kSplat) run.warn_unused({"--model"}, "with a splat");
    if (kind == SourceKind::kScene) run.warn_unused({"--hold-out"}, "with a scene.json, which says it itself");
    if (fs::is_regular_file(source.value)) run.add_input("source", source.value);
    return cut(run, options,
               {.source = source.value,
                .kind = kind,
                .strokes = strokes.paths,
                .model = model.path,
                .masks = masks.path,
                .truth = truth.path,
                .images = images.path,
                .world_transform = world.path,
                .import_words = given_words(tool.option_set(), kCaptureGroup),
                .all_words = given_words(tool.option_set()),
                .own_flags = own_flags(tool.option_set()),
                .out = out ? out.path : default_folder(source.value)});
  });
}

}  // namespace ngs::front
