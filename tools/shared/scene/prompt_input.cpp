#include "shared/scene/prompt_input.h"

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "ngs/core/error.h"
#include "ngs/io/files/content_hash.h"
#include "ngs/io/image/image_file.h"
#include "ngs/io/scene/painted_picture.h"
#include "ngs/io/scene/prompt_files.h"
#include "ngs/render/render_stage.h"
#include "ngs/scene/view_names.h"

namespace ngs::cli {
namespace {

bool is_json(const std::string& path) {
  if (std::filesystem::path(path).extension() == ".json") return true;
  char first = 0;
  return (std::ifstream(path) >> first) && first == '{';  // no image format begins with a brace
}

struct PromptFile {
  std::string path;
  bool in_folder = false;  // found in a given folder
};

/// Files unchanged; folders replaced by all files in them that may be prompts.
std::vector<PromptFile> files_of(const std::vector<std::string>& paths) {
  namespace fs = std::filesystem;
  std::vector<PromptFile> files;
  for (const std::string& path : paths) {
    std::error_code unreadable;
    if (!fs::is_directory(path, unreadable)) {
      files.push_back({path});
      continue;
    }
    std::vector<std::string> inside;
    for (const fs::directory_entry& entry : fs::directory_iterator(path, unreadable))
      for (const char* ending : {".png", ".jpg", ".jpeg", ".json"})
        if (entry.path().extension() == ending) inside.push_back(entry.path().generic_string());
    if (inside.empty())
      throw Error(ErrorCode::kBadInput, path + ": no prompts in this folder, expected PNG, JPEG or JSON files",
                  "put painted copies of the photos into it, under the same names");
    std::sort(inside.begin(), inside.end());
    for (std::string& file : inside) files.push_back({std::move(file), true});
  }
  return files;
}

bool has_same_bytes(const std::string& a, const std::string& b) {
  std::error_code unreadable;
  return std::filesystem::file_size(a, unreadable) == std::filesystem::file_size(b, unreadable) && !unreadable &&
         io::content_hash(a).xxh3 == io::content_hash(b).xxh3;
}

struct ViewFinder {
  const Run& run;
  const Scene& scene;
  const std::string& wanted;  // --view
  ViewNames names{scene.views};

  /// The view of prompts that name the view `named` (may be empty) in the file `path` (empty: ignore the file name).
  std::size_t view_of(const std::string& named, const std::string& path) const {
    std::string name = !wanted.empty() ? wanted : named;
    if (name.empty() && !path.empty() && !run.comes_from_stream(path)) name = named_like(path);
    if (name.empty())
      throw Error(ErrorCode::kUsage, (path.empty() ? "" : path + ": ") + "the prompts name no view",
                  "give --view NAME, or name the file after the photo");
    const std::size_t view = only(name);
    const std::vector<std::size_t> other = names.find(named);
    if (!named.empty() && other.size() == 1 && other[0] != view)
      throw Error(ErrorCode::kUsage, "view = " + name + ": the prompts name " + named + ", expected one view",
                  "leave --view out, or give the prompts of that view");
    return view;
  }

 private:
  std::size_t only(const std::string& name) const {
    const std::vector<std::size_t> found = names.find(name);
    if (found.size() == 1) return found[0];
    throw Error(ErrorCode::kUsage,
                "view = " + name + ": " + (found.empty() ? "no view" : "several views") + " of that name, expected one",
                "choose one with --view NAME; the first view is '" + scene.views.front().camera.name + "'");
  }
  std::string named_like(const std::string& path) const {
    const std::string stem = std::filesystem::path(path).stem().string();
    std::string name;
    for (const SceneView& view : scene.views) {
      if (image_stem(bare_name(view.camera.name)) != stem) continue;
      if (!name.empty())
        throw Error(ErrorCode::kUsage,
                    path + ": matches the names of several views, " + name + " and " + view.camera.name,
                    "choose one with --view NAME");
      name = view.camera.name;
    }
    return name;
  }
};

}  // namespace

Marks read_prompts(const Run& run, const Scene& scene, const std::string& wanted,
                   const std::vector<std::string>& paths) {
  const ViewFinder finder{run, scene, wanted};
  Marks marks;
  for (const auto& [path, in_folder] : files_of(paths)) {
    if (is_json(path)) {
      for (HandPrompt& prompt : io::read_prompts_json(path))
        marks[finder.view_of(prompt.view, path)].push_back(std::move(prompt));
    } else {
      const std::size_t view = finder.view_of("", path);
      std::error_code none;
      if (in_folder && has_same_bytes(path, scene.views[view].image_path)) continue;  // copied, but not painted
      if (std::filesystem::equivalent(path, scene.views[view].image_path, none))
        throw Error(ErrorCode::kBadInput, path + ": is the photo of the view, expected a painted copy",
                    "restore the photo, and paint on a copy with the same name in another folder");
      marks[view].push_back(io::read_painted_picture(path, scene.views[view].image_path));
    }
  }
  if (marks.empty() && !paths.empty())
    throw Error(ErrorCode::kBadInput, paths.front() + ": no copy in this folder is painted, expected one at least",
                "paint the object green (0, 255, 0) and the background red (255, 0, 0)");
  return marks;
}

void check_prompt_files(const std::vector<std::string>& paths) {
  for (const PromptFile& file : files_of(paths)) {
    if (is_json(file.path))
      io::read_prompts_json(file.path);
    else
      io::read_image_size(file.path);
  }
}

Marks read_marks(const Run& run, const Scene& scene, const std::string& wanted, const PromptInputs& inputs) {
  const bool pictures = inputs.object || inputs.background;
  if (bool(inputs.prompts) == pictures)
    throw Error(
        ErrorCode::kUsage,
        inputs.prompts ? "--prompts and scribble pictures are both given, expected one kind" : "no prompts are given",
        "mark the object on photos: --prompts strokes.json, --prompts scribbles.png, or --object-scribbles pos.png "
        "--background-scribbles neg.png");
  if (!pictures) return read_prompts(run, scene, wanted, inputs.prompts.paths);
  Marks marks;
  HandPrompt prompt;
  if (inputs.background) io::add_scribbles(inputs.background.path, false, prompt);
  if (inputs.object) io::add_scribbles(inputs.object.path, true, prompt);
  marks[ViewFinder{run, scene, wanted}.view_of("", "")].push_back(std::move(prompt));
  return marks;
}

}  // namespace ngs::cli
