#pragma once
// The marks of a person, from whichever files they come in.
#include "ngs/scene/hand_prompt.h"
#include "ngs/scene/scene.h"
#include "shared/run/run.h"

namespace ngs::cli {

struct PromptInputs {
  const Inputs& prompts;  // JSON, or pictures painted in green and red
  const Input& object;    // pictures, one per side
  const Input& background;
};

/// All marks by the view that they are of. kUsage where there are none, or both kinds; background alone is a prompt
/// too. A file of prompts is JSON if it is called so or begins with a brace, else a picture. The view of marks is the
/// one that they name, else `wanted`, else the one whose stem the file name has. kUsage where there is no such view, or
/// where the marks name another view than `wanted`.
std::map<std::size_t, std::vector<HandPrompt>> read_marks(const Run& run, const Scene& scene, const std::string& wanted,
                                                          const PromptInputs& inputs);

}  // namespace ngs::cli
