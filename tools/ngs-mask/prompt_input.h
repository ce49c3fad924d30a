#pragma once
// The marks of a person, from whichever files they come in.
#include "ngs/scene/hand_prompt.h"
#include "ngs/scene/scene.h"
#include "shared/run/run.h"

namespace ngs::cli {

struct PromptInputs {
  const Input& prompts;  // JSON or a picture in green and red
  const Input& object;   // pictures, one per side
  const Input& background;
};

/// kUsage where there are none, or both kinds; kNothingFound is not thrown here: background alone is a prompt
/// too. Prompts are JSON if their file is called so or begins with a brace, else a picture.
HandPrompt read_prompts(const PromptInputs& inputs);

/// Index of the view that the marks are of: `wanted`, else the one that the prompts name, else the one whose
/// stem the file name has. kUsage where there is none, or where the prompts name another view of the scene than
/// `wanted`.
std::size_t reference_view(const Run& run, const Scene& scene, const std::string& wanted, const HandPrompt& prompt,
                           const PromptInputs& inputs);

}  // namespace ngs::cli
