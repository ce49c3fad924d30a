#include "ngs/io/scene/prompt_files.h"

#include <algorithm>
#include <cmath>

#include "ngs/core/error.h"
#include "ngs/io/files/json_file.h"
#include "ngs/io/image/image_file.h"

namespace ngs::io {
namespace {

constexpr std::int64_t kMostSide = 1 << 16;
constexpr std::size_t kMostPoints = 1 << 20;

/// Clicks beside the picture, or coordinates of another size of it.
void require_inside(const JsonReader& reader, const char* key, const HandPrompt& prompt, std::array<double, 4> box) {
  if (box[2] <= 0 || box[3] <= 0 || box[0] >= prompt.width_px || box[1] >= prompt.height_px)
    reader.fail(key, "coordinates in the " + to_string({prompt.width_px, prompt.height_px}) +
                         " px of \"width\" and \"height\"");
}

PromptStroke stroke_of(const nlohmann::json& value, const std::string& where, const HandPrompt& prompt) {
  const JsonReader reader(value, where);
  PromptStroke stroke;
  stroke.object = reader.boolean("object");
  stroke.radius_px = reader.number_or("radius", 3);
  if (!(stroke.radius_px > 0 && stroke.radius_px <= double(kMostSide)))
    reader.fail("radius", "a positive number of pixels");
  const nlohmann::json& points = reader.array("points");
  if (points.empty() || points.size() > kMostPoints) reader.fail("points", "1 to 1048576 points");
  const std::vector<double> flat = reader.matrix("points", points.size(), 2);
  std::array<double, 4> box{flat[0], flat[1], flat[0], flat[1]};
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double x = flat[2 * i], y = flat[2 * i + 1];
    stroke.points.push_back({x, y});
    box = {std::min(box[0], x), std::min(box[1], y), std::max(box[2], x), std::max(box[3], y)};
  }
  const double r = stroke.radius_px;
  require_inside(reader, "points", prompt, {box[0] - r, box[1] - r, box[2] + r, box[3] + r});
  reader.refuse_unknown_keys();
  return stroke;
}

/// 0..255
int sample_of(const RawMask& picture, std::size_t pixel, std::size_t channel) {
  const int value = picture.data[pixel * std::size_t(picture.channels) + channel];
  return picture.bits == 16 ? value / 257 : value;
}

/// Where a picture can be seen through it is not painted, whatever the colour that its file keeps there.
bool is_see_through(const RawMask& picture, std::size_t pixel) {
  return picture.channels == 4 && sample_of(picture, pixel, 3) < 128;
}

/// Not black.
bool is_painted(const RawMask& picture, std::size_t pixel) {
  if (is_see_through(picture, pixel)) return false;
  for (std::size_t c = 0; c < std::size_t(std::min(picture.channels, 3)); ++c)
    if (picture.data[pixel * std::size_t(picture.channels) + c] > 0) return true;
  return false;
}

/// The mark of one sample of a colour picture.
PixelHint mark_of(const RawMask& picture, std::size_t pixel) {
  if (is_see_through(picture, pixel)) return PixelHint::kLikelyBackground;
  const bool red = sample_of(picture, pixel, 0) >= 128, green = sample_of(picture, pixel, 1) >= 128;
  return red == green ? PixelHint::kLikelyBackground : green ? PixelHint::kObject : PixelHint::kBackground;
}

bool is_marked(const HandPrompt& prompt) {
  for (const PixelHint hint : prompt.painted)
    if (is_certain(hint)) return true;
  return false;
}

}  // namespace

HandPrompt parse_prompts_json(const nlohmann::json& root, const std::string& object) {
  const JsonReader reader(root, object);
  if (reader.integer("ngs_prompts", 1, 1) != 1) reader.fail("ngs_prompts", "1");
  HandPrompt prompt;
  prompt.view = reader.text_or("view", "");
  prompt.width_px = int(reader.integer("width", 1, kMostSide));
  prompt.height_px = int(reader.integer("height", 1, kMostSide));
  if (reader.has("strokes"))
    for (const nlohmann::json& value : reader.array("strokes"))
      prompt.strokes.push_back(
          stroke_of(value, object + ": strokes[" + std::to_string(prompt.strokes.size()) + "]", prompt));
  if (reader.has("boxes")) {
    const std::size_t count = reader.array("boxes").size();
    const std::vector<double> flat = count > 0 ? reader.matrix("boxes", count, 4) : std::vector<double>{};
    for (std::size_t i = 0; i < count; ++i) {
      const double* b = &flat[4 * i];
      if (!(b[0] < b[2] && b[1] < b[3])) reader.fail("boxes", "left < right and top < bottom");
      require_inside(reader, "boxes", prompt, {b[0], b[1], b[2], b[3]});
      prompt.boxes.push_back({b[0], b[1], b[2], b[3]});
    }
  }
  for (const char* ignored : {"points", "mask"}) static_cast<void>(reader.has(ignored));
  reader.refuse_unknown_keys();
  if (prompt.strokes.empty() && prompt.boxes.empty())
    throw Error(ErrorCode::kBadInput, object + ": neither strokes nor boxes, expected at least one");
  return prompt;
}

HandPrompt read_prompts_json(const std::string& path) { return parse_prompts_json(read_json_file(path), path); }

HandPrompt read_scribbles(const std::string& path) {
  const RawMask picture = read_mask_raw(path, Palette::kColours);
  if (picture.channels < 3)
    throw Error(ErrorCode::kBadInput, path + ": a grey picture, expected green (object) and red (background) strokes",
                "give one picture per side: --object-scribbles PNG --background-scribbles PNG");
  HandPrompt prompt;
  prompt.width_px = picture.width_px, prompt.height_px = picture.height_px;
  prompt.painted.resize(std::size_t(picture.width_px) * std::size_t(picture.height_px));
  for (std::size_t p = 0; p < prompt.painted.size(); ++p) prompt.painted[p] = mark_of(picture, p);
  if (!is_marked(prompt))
    throw Error(ErrorCode::kBadInput,
                path + ": nothing is marked, expected green (object) or red (background) strokes");
  return prompt;
}

void add_scribbles(const std::string& path, bool object, HandPrompt& prompt) {
  const RawMask picture = read_mask_raw(path, Palette::kColours);
  if (prompt.painted.empty()) {
    prompt.width_px = picture.width_px, prompt.height_px = picture.height_px;
    prompt.painted.assign(std::size_t(picture.width_px) * std::size_t(picture.height_px), PixelHint::kLikelyBackground);
  }
  if (picture.width_px != prompt.width_px || picture.height_px != prompt.height_px)
    throw Error(ErrorCode::kInconsistent, path + ": " + to_string({picture.width_px, picture.height_px}) +
                                              " px, expected " + to_string({prompt.width_px, prompt.height_px}) +
                                              " px as the other scribbles");
  bool any = false;
  for (std::size_t p = 0; p < prompt.painted.size(); ++p)
    if (is_painted(picture, p)) any = true, prompt.painted[p] = object ? PixelHint::kObject : PixelHint::kBackground;
  if (!any) throw Error(ErrorCode::kBadInput, path + ": all black, expected strokes of another colour");
}

}  // namespace ngs::io
