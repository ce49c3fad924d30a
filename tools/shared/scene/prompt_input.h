#pragma once
// Reads user prompts (strokes, scribbles) from JSON files or painted pictures.
#include <map>
#include <string>
#include <vector>

#include "ngs/scene/hand_prompt.h"
#include "ngs/scene/scene.h"
#include "shared/run/run.h"

namespace ngs::cli {

struct PromptInputs {
  const Inputs& prompts;  // JSON, or pictures painted in green and red
  const Input& object;    // pictures, one per side
  const Input& background;
};

/// Prompts by view index.
using Marks = std::map<std::size_t, std::vector<HandPrompt>>;

/// Returns all prompts by view. Throws kUsage if there are none, or both prompts and scribbles; background alone is a
/// valid prompt. A prompt file is JSON if its name ends in .json or it begins with a brace, else a picture. The view is
/// the one named in the file, else `wanted`, else the one whose stem the file name has. Throws kUsage if there is no
/// such view, or if the file names a view other than `wanted`.
Marks read_marks(const Run& run, const Scene& scene, const std::string& wanted, const PromptInputs& inputs);

/// The same for prompt files and folders: all PNG, JPEG and JSON files in a folder, sorted by name, without pictures
/// that are unchanged copies of their photo. Throws kBadInput for a folder without any.
Marks read_prompts(const Run& run, const Scene& scene, const std::string& wanted,
                   const std::vector<std::string>& paths);

/// Reads the files without the views, for a dry run: JSON completely, of pictures the size. Throws as read_prompts().
void check_prompt_files(const std::vector<std::string>& paths);

}  // namespace ngs::cli
