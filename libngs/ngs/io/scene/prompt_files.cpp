#include "ngs/io/scene/prompt_files.h"

#include <algorithm>

#include "ngs/core/error.h"
#include "ngs/io/files/json_file.h"
#include "ngs/io/image/image_file.h"
#include "ngs/io/scene/picture_samples.h"

namespace ngs::io {
namespace {

constexpr std::int64_t kMaxPictureSide_px = 1 << 16;
constexpr std::size_t kMaxPoints = 1 << 20, kMaxCorners = 1 << 16;
constexpr double kRadiusPx = 3;
/// A stroke may extend beyond the picture by this share of the larger side.
constexpr double kSlip = 0.1;
/// Colours of a scribble or mask, compressed or not, differ by at most this from its one colour.
constexpr int kScribbleDistance = 64;

/// Error for marks outside the picture, or coordinates that refer to another image size.
[[noreturn]] void refuse_place(const JsonReader& reader, const char* key, const HandPrompt& prompt) {
  reader.fail(
      key, "coordinates in the " + to_string({prompt.width_px, prompt.height_px}) + " px of \"width\" and \"height\"");
}

void require_inside(const JsonReader& reader, const char* key, const HandPrompt& prompt, std::array<double, 4> box) {
  if (box[2] <= 0 || box[3] <= 0 || box[0] >= prompt.width_px || box[1] >= prompt.height_px)
    refuse_place(reader, key, prompt);
}

/// The points of a stroke or polygon: at least a part must be inside, and none farther outside than kSlip.
std::vector<std::array<double, 2>> points_of(const JsonReader& reader, const HandPrompt& prompt, double radius_px) {
  const std::size_t count = reader.array("points").size();
  const std::vector<double> flat = reader.matrix("points", count, 2);
  const double slip = radius_px + kSlip * std::max(prompt.width_px, prompt.height_px);
  std::vector<std::array<double, 2>> points;
  std::array<double, 4> box{flat[0], flat[1], flat[0], flat[1]};
  for (std::size_t i = 0; i < count; ++i) {
    const double x = flat[2 * i], y = flat[2 * i + 1];
    if (!(x >= -slip && y >= -slip && x <= prompt.width_px + slip && y <= prompt.height_px + slip))
      refuse_place(reader, "points", prompt);
    points.push_back({x, y});
    box = {std::min(box[0], x), std::min(box[1], y), std::max(box[2], x), std::max(box[3], y)};
  }
  const double r = radius_px;
  require_inside(reader, "points", prompt, {box[0] - r, box[1] - r, box[2] + r, box[3] + r});
  return points;
}

PromptStroke stroke_of(const nlohmann::json& value, const std::string& where, const HandPrompt& prompt) {
  const JsonReader reader(value, where);
  PromptStroke stroke;
  stroke.object = reader.boolean("object");
  stroke.radius_px = reader.number_or("radius", kRadiusPx);
  if (!(stroke.radius_px > 0 && stroke.radius_px <= double(kMaxPictureSide_px)))
    reader.fail("radius", "a positive number of pixels");
  const std::size_t count = reader.array("points").size();
  if (count == 0 || count > kMaxPoints) reader.fail("points", "1 to 1048576 points");
  stroke.points = points_of(reader, prompt, stroke.radius_px);
  reader.refuse_unknown_keys();
  return stroke;
}

PromptPolygon polygon_of(const nlohmann::json& value, const std::string& where, const HandPrompt& prompt) {
  const JsonReader reader(value, where);
  const std::size_t count = reader.array("points").size();
  if (count < 3 || count > kMaxCorners) reader.fail("points", "3 to 65536 points");
  PromptPolygon polygon{reader.boolean("object"), points_of(reader, prompt, 0)};
  reader.refuse_unknown_keys();
  return polygon;
}

/// Reads a click as a stroke of one point.
PromptStroke click_of(const nlohmann::json& value, const std::string& where, const HandPrompt& prompt) {
  const JsonReader reader(value, where);
  const double x = reader.number("x"), y = reader.number("y");
  PromptStroke click{reader.boolean("object"), kRadiusPx, {{x, y}}};
  if (!(x >= 0 && y >= 0 && x <= prompt.width_px && y <= prompt.height_px)) refuse_place(reader, "x", prompt);
  reader.refuse_unknown_keys();
  return click;
}

void read_boxes(const JsonReader& reader, HandPrompt& prompt) {
  const std::size_t count = reader.array("boxes").size();
  const std::vector<double> flat = count > 0 ? reader.matrix("boxes", count, 4) : std::vector<double>{};
  for (std::size_t i = 0; i < count; ++i) {
    const double* b = &flat[4 * i];
    if (!(b[0] < b[2] && b[1] < b[3])) reader.fail("boxes", "left < right and top < bottom");
    require_inside(reader, "boxes", prompt, {b[0], b[1], b[2], b[3]});
    prompt.boxes.push_back({b[0], b[1], b[2], b[3]});
  }
}

/// "ngs_prompts": 1 is one view, whose additional segmenter inputs are ignored; 2 has a list "views".
enum class Form : std::uint8_t { kOneView, kViews };

HandPrompt marks_of(const JsonReader& reader, const std::string& object, Form form) {
  HandPrompt prompt;
  prompt.view = reader.text_or("view", "");
  prompt.width_px = int(reader.integer("width", 1, kMaxPictureSide_px));
  prompt.height_px = int(reader.integer("height", 1, kMaxPictureSide_px));
  const auto each = [&](const char* key, const auto& read) {
    std::size_t count = 0;
    if (reader.has(key))
      for (const nlohmann::json& value : reader.array(key))
        read(value, object + ": " + key + "[" + std::to_string(count++) + "]");
  };
  each("strokes",
       [&](const auto& value, const std::string& where) { prompt.strokes.push_back(stroke_of(value, where, prompt)); });
  if (reader.has("boxes")) read_boxes(reader, prompt);
  if (form == Form::kViews) {
    each("polygons", [&](const auto& value, const std::string& where) {
      prompt.polygons.push_back(polygon_of(value, where, prompt));
    });
    each("points", [&](const auto& value, const std::string& where) {
      prompt.strokes.push_back(click_of(value, where, prompt));
    });
  } else {
    for (const char* ignored : {"points", "mask"}) static_cast<void>(reader.has(ignored));
  }
  reader.refuse_unknown_keys();
  if (prompt.strokes.empty() && prompt.boxes.empty() && prompt.polygons.empty())
    throw Error(ErrorCode::kBadInput,
                object + (form == Form::kViews ? ": no strokes, points, polygons or boxes, expected at least one"
                                               : ": neither strokes nor boxes, expected at least one"));
  return prompt;
}

/// Whether a pixel is neither black nor transparent.
bool is_painted(const RawMask& picture, std::size_t pixel) {
  if (is_see_through(picture, pixel)) return false;
  for (std::size_t c = 0; c < std::size_t(std::min(picture.channels, 3)); ++c)
    if (picture.data[pixel * std::size_t(picture.channels) + c] > 0) return true;
  return false;
}

/// A mask or scribbles have one colour, whatever share of the picture they cover.
void refuse_photo(const std::string& path, const RawMask& picture) {
  const auto pixels = std::size_t(picture.width_px) * std::size_t(picture.height_px);
  ColourCounts colours;
  std::size_t marked = 0, other = 0;
  for (std::size_t p = 0; p < pixels; ++p)
    if (is_painted(picture, p)) {
      ++marked;
      colours.add(colour_of(picture, p));
    }
  const Colour8 usual = colours.most_frequent();
  for (std::size_t p = 0; p < pixels; ++p)
    other += is_painted(picture, p) && distance_of(colour_of(picture, p), usual) > kScribbleDistance;
  if (2 * marked > pixels && 2 * other > marked)
    throw Error(ErrorCode::kBadInput,
                path + ": " + std::to_string(100 * marked / pixels) +
                    " % of the picture is not black and has many colours, expected strokes of one colour on black or "
                    "transparency",
                "export the strokes on black, without the photo");
}

}  // namespace

std::vector<HandPrompt> parse_prompts_json(const nlohmann::json& root, const std::string& object) {
  const JsonReader reader(root, object);
  std::vector<HandPrompt> prompts;
  if (reader.integer("ngs_prompts", 1, 2) == 1) return {marks_of(reader, object, Form::kOneView)};
  for (const nlohmann::json& view : reader.array("views")) {
    const std::string where = object + ": views[" + std::to_string(prompts.size()) + "]";
    prompts.push_back(marks_of(JsonReader(view, where), where, Form::kViews));
  }
  if (prompts.empty()) reader.fail("views", "at least one view");
  reader.refuse_unknown_keys();
  return prompts;
}

std::vector<HandPrompt> read_prompts_json(const std::string& path) {
  return parse_prompts_json(read_json_file(path), path);
}

void add_scribbles(const std::string& path, bool object, HandPrompt& prompt) {
  const RawMask picture = read_mask_raw(path, Palette::kColours);
  refuse_photo(path, picture);
  if (prompt.painted.empty()) {
    prompt.width_px = picture.width_px;
    prompt.height_px = picture.height_px;
    prompt.painted.assign(std::size_t(picture.width_px) * std::size_t(picture.height_px), PixelHint::kLikelyBackground);
  }
  if (picture.width_px != prompt.width_px || picture.height_px != prompt.height_px)
    throw Error(ErrorCode::kInconsistent, path + ": " + to_string({picture.width_px, picture.height_px}) +
                                              " px, expected " + to_string({prompt.width_px, prompt.height_px}) +
                                              " px as the other scribbles");
  bool any = false;
  for (std::size_t p = 0; p < prompt.painted.size(); ++p)
    if (is_painted(picture, p)) {
      any = true;
      prompt.painted[p] = object ? PixelHint::kObject : PixelHint::kBackground;
    }
  if (!any) throw Error(ErrorCode::kBadInput, path + ": all black, expected strokes of another colour");
}

}  // namespace ngs::io
