#pragma once
// Prompts of a person, and prompts for a segmenter (data-schema/prompts.schema.json).
//
//   {"ngs_prompts": 1, "view": NAME (optional), "width": PX, "height": PX,
//    "strokes": [{"object": BOOL, "radius": PX (default 3), "points": [[X, Y], ...]}],
//    "boxes": [[LEFT, TOP, RIGHT, BOTTOM], ...]}
//
//   {"ngs_prompts": 2, "views": [{"view", "width", "height", "strokes", "boxes",
//    "polygons": [{"object": BOOL, "points": [[X, Y], ...]}], "points": [{"object": BOOL, "x": X, "y": Y}]}, ...]}
//
// Coordinates are of the image of that size; pixel (i, j) has its centre at (i + 0.5, j + 0.5). At least one mark of a
// view. In the first form, which is also what a segmenter is told, "points" and "mask" (the file of the rendered
// consensus, 0/255, PNG) are ignored when read; in the second a point is a stroke of one point.
//
// Grey or one-sided scribble pictures (NVOS: pos_*.png, neg_*.png): see add_scribbles. Pictures painted green and red:
// io/scene/painted_picture.h.
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "ngs/scene/hand_prompt.h"

namespace ngs::io {

/// One entry per view that the file describes, at least one. kBadInput for anything else than described, for a mark
/// that lies beside the image, for a point of a stroke or polygon far beside it, and for files beyond 64 MiB.
std::vector<HandPrompt> read_prompts_json(const std::string& path);
std::vector<HandPrompt> parse_prompts_json(const nlohmann::json& root, const std::string& object);

/// Marks every pixel of a picture that is neither black nor see-through as one side, over what `prompt` has. The first
/// picture decides the size; another size is kInconsistent. kBadInput where nothing is marked, and where the picture is
/// a photo: most of it in many colours.
void add_scribbles(const std::string& path, bool object, HandPrompt& prompt);

}  // namespace ngs::io
