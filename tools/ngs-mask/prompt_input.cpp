#include "prompt_input.h"

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "ngs/core/error.h"
#include "ngs/io/scene/prompt_files.h"
#include "ngs/scene/view_names.h"
#include "ngs/stages/render/render_stage.h"

namespace ngs::cli {
namespace {

bool is_json(const std::string& path) {
  if (std::filesystem::path(path).extension() == ".json") return true;
  char first = 0;
  return (std::ifstream(path) >> first) && first == '{';  // no picture begins with a brace
}

}  // namespace

HandPrompt read_prompts(const PromptInputs& inputs) {
  const bool pictures = inputs.object || inputs.background;
  if (bool(inputs.prompts) == pictures)
    throw Error(
        ErrorCode::kUsage,
        inputs.prompts ? "--prompts and scribble pictures are both given, expected one kind" : "no prompts are given",
        "mark the object on one photo: --prompts strokes.json, --prompts scribbles.png, or "
        "--object-scribbles pos.png "
        "--background-scribbles neg.png");
  if (inputs.prompts)
    return is_json(inputs.prompts.path) ? io::read_prompts_json(inputs.prompts.path)
                                        : io::read_scribbles(inputs.prompts.path);
  HandPrompt prompt;
  if (inputs.background) io::add_scribbles(inputs.background.path, false, prompt);
  if (inputs.object) io::add_scribbles(inputs.object.path, true, prompt);
  return prompt;
}

std::size_t reference_view(const Run& run, const Scene& scene, const std::string& wanted, const HandPrompt& prompt,
                           const PromptInputs& inputs) {
  std::string name = !wanted.empty() ? wanted : prompt.view;
  if (name.empty() && inputs.prompts && !run.comes_from_stream(inputs.prompts)) {
    const std::string stem = std::filesystem::path(inputs.prompts.path).stem().string();
    for (const SceneView& view : scene.views) {
      if (image_stem(bare_name(view.camera.name)) != stem) continue;
      if (!name.empty())
        throw Error(ErrorCode::kUsage,
                    inputs.prompts.path + ": has the name of several views, " + name + " and " + view.camera.name,
                    "say which with --view NAME");
      name = view.camera.name;
    }
  }
  if (name.empty())
    throw Error(ErrorCode::kUsage, "the prompts do not say which view they are of",
                "give --view NAME, or name the file after the photo");
  const ViewNames names(scene.views);
  const std::vector<std::size_t> found = names.find(name);
  if (found.size() != 1)
    throw Error(ErrorCode::kUsage,
                "view = " + name + ": " + (found.empty() ? "no view" : "several views") + " of that name, expected one",
                "say which with --view NAME; the first is '" + scene.views.front().camera.name + "'");
  const std::vector<std::size_t> said = names.find(prompt.view);
  if (!prompt.view.empty() && said.size() == 1 && said[0] != found[0])
    throw Error(ErrorCode::kUsage, "view = " + name + ": the prompts are of " + prompt.view + ", expected one view",
                "leave --view out, or give the prompts of that view");
  return found[0];
}

}  // namespace ngs::cli
