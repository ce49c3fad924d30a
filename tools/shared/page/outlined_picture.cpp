#include "shared/page/outlined_picture.h"

#include "ngs/io/image/image_file.h"
#include "ngs/ops/image/outline.h"
#include "shared/page/html.h"

namespace ngs::cli {
namespace {

std::string path_data(MaskPlane mask) {
  std::string d;
  for (const Loop& loop : outlines(mask)) {
    GridPoint at = loop.back();
    d += "M" + std::to_string(at.x) + " " + std::to_string(at.y);
    for (std::size_t i = 0; i + 1 < loop.size(); ++i) {
      const GridPoint next = loop[i];
      d += next.y == at.y ? "h" + std::to_string(next.x - at.x) : "v" + std::to_string(next.y - at.y);
      at = next;
    }
    d += "z";
  }
  return d;
}

std::string outline_html(const Outline& outline) {
  if (outline.mask.data == nullptr) return {};
  const std::string d = path_data(outline.mask);
  const std::string stroke = outline.colour.empty() ? "" : " style=\"stroke:" + escaped(outline.colour) + "\"";
  return "<g class=" + outline.kind + "><path class=casing d=\"" + d + "\"/><path" + stroke + " d=\"" + d + "\"/></g>";
}

}  // namespace

std::string jpeg_source(const ImageU8& picture, int quality) {
  return "data:image/jpeg;base64," + base64(io::encode_jpeg(picture, quality));
}

std::string outlined_picture(const ImageU8& picture, const std::vector<Outline>& outlines, const PixelWindow& view_box,
                             const std::string& alt) {
  std::string html = "<div class=stack><img alt=\"" + escaped(alt) + "\" width=" + std::to_string(picture.width_px) +
                     " height=" + std::to_string(picture.height_px) + " src=\"" +
                     jpeg_source(picture, picture.width_px < 200 ? 92 : 82) + "\">";
  html += "<svg aria-hidden=true viewBox=\"" + std::to_string(view_box.x0) + " " + std::to_string(view_box.y0) + " " +
          std::to_string(view_box.w) + " " + std::to_string(view_box.h) + "\">";
  for (const Outline& outline : outlines) html += outline_html(outline);
  return html + "</svg></div>";
}

}  // namespace ngs::cli
