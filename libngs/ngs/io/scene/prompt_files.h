#pragma once
// The user's prompts, and prompts for a segmenter (data-schema/prompts.schema.json).
//
//   {"ngs_prompts": 1, "view": NAME (optional), "width": PX, "height": PX,
//    "strokes": [{"object": BOOL, "radius": PX (default 3), "points": [[X, Y], ...]}],
//    "boxes": [[LEFT, TOP, RIGHT, BOTTOM], ...]}
//
//   {"ngs_prompts": 2, "views": [{"view", "width", "height", "strokes", "boxes",
//    "polygons": [{"object": BOOL, "points": [[X, Y], ...]}], "points": [{"object": BOOL, "x": X, "y": Y}]}, ...]}
//
// Coordinates refer to an image of that size; pixel (i, j) has its centre at (i + 0.5, j + 0.5). A view has at least
// one mark. In the first form, which is also the input of segmenters, "points" and "mask" (PNG file of the rendered
// consensus, 0/255) are ignored by the reader; in the second form a point is a stroke of one point.
//
// Grey or one-sided scribble pictures (NVOS: pos_*.png, neg_*.png): see add_scribbles(). Pictures painted green and
// red: io/scene/painted_picture.h.
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "ngs/scene/hand_prompt.h"

namespace ngs::io {

/// One entry per view in the file, at least one. kBadInput if the file does not follow the description above, if a mark
/// lies outside the image, if a point of a stroke or polygon lies far outside it, and for files beyond 64 MiB.
std::vector<HandPrompt> read_prompts_json(const std::string& path);
std::vector<HandPrompt> parse_prompts_json(const nlohmann::json& root, const std::string& object);

/// Marks every pixel of a picture that is neither black nor transparent as object or background, over the marks in
/// `prompt`. The first picture determines the size; another size is kInconsistent. kBadInput if nothing is marked, or
/// if the picture is a photo: most of it in many colours.
void add_scribbles(const std::string& path, bool object, HandPrompt& prompt);

}  // namespace ngs::io
