#pragma once
// JSON of a session: studio.json, strokes for ngs-mask, and masks converted to strokes.
#include "fields.h"
#include "ngs/interactive/marks.h"

namespace ngs::studio {

/// {"ngs_studio": 1, "source", "active", "next_id", "objects": [{"id", "name", "colour", "next_view",
///  "views": [{"name", "look": Camera, "strokes": [{"label", "radius_px", "points"}]}]}]}; of an object also
/// "edits", "hidden", "locked" and "keeps_dropped", if it has them
Json json_of(const live::Marks& marks, const std::string& source);
/// Inverse of json_of, without masks. Error(kBadInput) for invalid JSON and for another source.
live::Marks marks_of(const nlohmann::json& root, const std::string& source);

/// "#rrggbb"; a Refusal for anything else.
std::string colour_of(Fields& fields, const std::string& name);

/// A list of at least one pixel [x, y]; throws Refusal as Fields does.
std::vector<std::array<double, 2>> points_of(Fields& fields, const std::string& name);
/// Member "strokes" of a request and of studio.json; throws Refusal as Fields does.
std::vector<PromptStroke> strokes_of(Fields& request);
Json json_of(const std::vector<PromptStroke>& strokes);

/// Prompts of ngs-mask (data-schema/prompts.schema.json): the strokes of each view.
Json strokes_json(const live::ObjectMarks& object);
/// Prompts from the masks: one stroke per run of pixels, except in a band along the contour, which is segmented again.
Json marks_json(const live::ObjectMarks& object);
/// Name of a marked view in cut.json: "marked-0001.png".
std::string marked_name(const live::MarkedView& view);

}  // namespace ngs::studio
