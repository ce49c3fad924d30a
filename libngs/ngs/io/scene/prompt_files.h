#pragma once
// Prompts of a person, and prompts for a segmenter (data-schema/prompts.schema.json).
//
//   {"ngs_prompts": 1, "view": NAME (optional), "width": PX, "height": PX,
//    "strokes": [{"object": BOOL, "radius": PX (default 3), "points": [[X, Y], ...]}],
//    "boxes": [[LEFT, TOP, RIGHT, BOTTOM], ...]}
//
// Coordinates are of the image of that size; pixel (i, j) has its centre at (i + 0.5, j + 0.5). At least one
// stroke or box. For a segmenter there are also "points": [{"object": BOOL, "x": X, "y": Y}] and "mask": the
// file of the rendered consensus (0/255, PNG); these are ignored when read.
//
// Scribble pictures (PNG): green is the object (G >= 128, R < 128), red the background (R >= 128, G < 128);
// all else is unmarked, as is what can be seen through. Grey or one-sided pictures (NVOS: pos_*.png, neg_*.png): see
// add_scribbles.
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "ngs/scene/hand_prompt.h"

namespace ngs::io {

/// kBadInput for anything else than described, for a stroke or box that lies beside the image, and for files beyond
/// 64 MiB.
HandPrompt read_prompts_json(const std::string& path);
HandPrompt parse_prompts_json(const nlohmann::json& root, const std::string& object);

/// A green and red picture. kBadInput where nothing is marked.
HandPrompt read_scribbles(const std::string& path);

/// Marks every pixel of a picture that is neither black nor see-through as one side, over what `prompt` has. The first
/// picture decides the size; another size is kInconsistent.
void add_scribbles(const std::string& path, bool object, HandPrompt& prompt);

}  // namespace ngs::io
