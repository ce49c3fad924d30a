#pragma once
// A visit as JSON: studio.json, strokes for ngs-mask, and masks said as strokes.
#include "fields.h"
#include "ngs/stages/live/marks.h"

namespace ngs::studio {

/// {"ngs_studio": 1, "source", "active", "next_id", "objects": [{"id", "name", "colour", "next_view",
///  "views": [{"name", "look": Camera, "strokes": [{"label", "radius_px", "points"}]}]}]}
Json json_of(const live::Marks& marks, const std::string& source);
/// Without masks. Error(kBadInput) for anything that json_of would not have written of this source.
live::Marks marks_of(const nlohmann::json& root, const std::string& source);

/// "#rrggbb"; a Refusal for anything else.
std::string colour_of(Fields& fields, const std::string& name);

/// "strokes" of a request and of studio.json; Refusals as of Fields.
std::vector<PromptStroke> strokes_of(Fields& request);
Json json_of(const std::vector<PromptStroke>& strokes);

/// Prompts of ngs-mask (data-schema/prompts.schema.json): the strokes of each view.
Json strokes_json(const live::ObjectMarks& object);
/// The same of the masks: rows of pixels, but for a band along the contour that is left to the colours.
Json marks_json(const live::ObjectMarks& object);
/// Of a marked view among others: "marked-0001.png".
std::string marked_name(const live::MarkedView& view);

}  // namespace ngs::studio
