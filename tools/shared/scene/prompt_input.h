#pragma once
// The marks of a person, from whichever files they come in.
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

/// By the index of the view that they are of.
using Marks = std::map<std::size_t, std::vector<HandPrompt>>;

/// All marks by the view that they are of. kUsage where there are none, or both kinds; background alone is a prompt
/// too. A file of prompts is JSON if it is called so or begins with a brace, else a picture. The view of marks is the
/// one that they name, else `wanted`, else the one whose stem the file name has. kUsage where there is no such view, or
/// where the marks name another view than `wanted`.
Marks read_marks(const Run& run, const Scene& scene, const std::string& wanted, const PromptInputs& inputs);

/// The same of files of prompts alone, and of folders: all PNG, JPEG and JSON files in them, by name. kBadInput for a
/// folder without any.
Marks read_prompts(const Run& run, const Scene& scene, const std::string& wanted,
                   const std::vector<std::string>& paths);

}  // namespace ngs::cli
