#include "ngs/io/scene/painted_picture.h"

#include <algorithm>

#include "ngs/core/error.h"
#include "ngs/core/formatted.h"
#include "ngs/io/image/size_rule.h"
#include "ngs/io/scene/picture_samples.h"

namespace ngs::io {
namespace {

/// A pixel whose colour differs more from the photo's is painted; JPEG compression changes a pixel less.
constexpr int kPaintDistance = 32;
/// If more of the unpainted pixels differ from the photo's, the picture was compressed (JPEG, WebP).
constexpr double kCompressedShare = 0.05;
/// In a compressed picture paint is this close to pure green or red; compression artefacts near strokes mostly are not.
constexpr int kPureDistance = 64;
/// Up to this distance from a stroke compression changes pixels strongly: half a block of 16 with subsampled chroma.
constexpr int kRingingPx = 8;
/// A marker's pixels are this close to its most frequent colour.
constexpr int kMarkerDistance = 64;
/// Largest difference between the channels of a grey pixel.
constexpr int kGreySpread = 16;
/// Width of the stroke edges, whose pixels are blended with the colour below.
constexpr int kFringePx = 2;
/// Limit of unclear pixels: kUnclearShare of the picture plus kUnclearOfMarks of the marked pixels.
constexpr double kUnclearShare = 0.005, kUnclearOfMarks = 0.25;
/// Least share of the photo's pixels that must be unpainted.
constexpr double kMinKept = 0.5;
/// The same for a scaled picture: a higher share, because no other pixels count as evidence against it.
constexpr double kMinKeptScaled = 0.8;

/// The mark that a colour means if it is paint.
PixelHint mark_of(const Colour8& colour) {
  const bool red = colour[0] >= 128, green = colour[1] >= 128;
  return red == green ? PixelHint::kLikelyBackground : green ? PixelHint::kObject : PixelHint::kBackground;
}

bool is_grey(const Colour8& colour) {
  const auto [low, high] = std::minmax({colour[0], colour[1], colour[2]});
  return high - low <= kGreySpread;
}

/// The interpretation of each pixel, and the pixels that are neither mark nor background.
struct Reading {
  std::vector<PixelHint> mark;        // [H·W] certain object or background; kLikelyBackground: unmarked
  std::vector<std::uint8_t> unclear;  // [H·W]
  explicit Reading(std::size_t pixels) : mark(pixels, PixelHint::kLikelyBackground), unclear(pixels) {}

  double share(PixelHint hint) const {
    return double(std::count(mark.begin(), mark.end(), hint)) / double(mark.size());
  }
  double marked() const { return share(PixelHint::kObject) + share(PixelHint::kBackground); }
  double unclear_share() const {
    return double(std::count(unclear.begin(), unclear.end(), 1)) / double(unclear.size());
  }
  bool is_clear() const { return marked() > 0 && unclear_share() <= kUnclearShare + kUnclearOfMarks * marked(); }

  /// Clears `unclear` at the edges of strokes, `fringe_px` wide.
  void forgive_fringes(ImageSize size, int fringe_px = kFringePx) {
    for (int y = 0; y < size.height_px; ++y)
      for (int x = 0; x < size.width_px; ++x) {
        std::uint8_t& at = unclear[index(x, y, size)];
        if (at && is_certain(mark[index(x, y, size)])) continue;  // a colour that differs from its marker's
        if (at && has_near(x, y, size, fringe_px, is_certain)) at = 0;
      }
  }

  /// Whether a pixel whose mark fulfils `matches` lies within `far_px` in x and in y.
  template <class Matches>
  bool has_near(int x, int y, ImageSize size, int far_px, const Matches& matches) const {
    for (int v = std::max(0, y - far_px); v <= std::min(size.height_px - 1, y + far_px); ++v)
      for (int u = std::max(0, x - far_px); u <= std::min(size.width_px - 1, x + far_px); ++u)
        if (matches(mark[index(u, v, size)])) return true;
    return false;
  }

  static std::size_t index(int x, int y, ImageSize size) {
    return std::size_t(y) * std::size_t(size.width_px) + std::size_t(x);
  }
};

std::size_t pixels_of(const RawMask& picture) { return std::size_t(picture.width_px) * std::size_t(picture.height_px); }

ImageSize size_of(const RawMask& picture) { return {picture.width_px, picture.height_px}; }

Reading read_markers(const RawMask& picture) {
  Reading reading(pixels_of(picture));
  ColourCounts of_object, of_background, of_ground;
  for (std::size_t p = 0; p < reading.mark.size(); ++p) {
    if (is_see_through(picture, p)) continue;
    const Colour8 colour = colour_of(picture, p);
    reading.mark[p] = mark_of(colour);
    (reading.mark[p] == PixelHint::kObject       ? of_object
     : reading.mark[p] == PixelHint::kBackground ? of_background
                                                 : of_ground)
        .add(colour);
  }
  const Colour8 object = of_object.most_frequent(), background = of_background.most_frequent(),
                ground = of_ground.most_frequent();
  for (std::size_t p = 0; p < reading.mark.size(); ++p) {
    if (is_see_through(picture, p)) continue;
    const Colour8 colour = colour_of(picture, p);
    const bool unmarked = !is_certain(reading.mark[p]);
    const Colour8& usual = unmarked ? ground : reading.mark[p] == PixelHint::kObject ? object : background;
    reading.unclear[p] =
        distance_of(colour, usual) > (unmarked ? kGreySpread : kMarkerDistance) && !(unmarked && is_grey(colour));
  }
  reading.forgive_fringes(size_of(picture));
  return reading;
}

struct PhotoReading {
  Reading marks;
  double kept;  // share of the photo's pixels that are unchanged
};

int distance_to_pure(const Colour8& colour, PixelHint mark) {
  return distance_of(colour, mark == PixelHint::kObject ? Colour8{0, 255, 0} : Colour8{255, 0, 0});
}

/// For compressed pictures: removes marks made by compression. Their colour is not pure; or the photo has that colour
/// at the same place and paint of the other colour is near.
void leave_out_artefacts(const RawMask& picture, const RawMask& photo, Reading& reading) {
  const ImageSize size = size_of(picture);
  const auto leave_out = [&](std::size_t p) {
    reading.mark[p] = PixelHint::kLikelyBackground;
    reading.unclear[p] = distance_of(colour_of(picture, p), colour_of(photo, p)) > 2 * kPaintDistance;
  };
  for (std::size_t p = 0; p < reading.mark.size(); ++p)
    if (is_certain(reading.mark[p]) && distance_to_pure(colour_of(picture, p), reading.mark[p]) > kPureDistance)
      leave_out(p);
  const Reading pure = reading;
  for (int y = 0; y < size.height_px; ++y)
    for (int x = 0; x < size.width_px; ++x) {
      const std::size_t p = Reading::index(x, y, size);
      const PixelHint mark = pure.mark[p];
      if (!is_certain(mark) || mark_of(colour_of(photo, p)) != mark) continue;
      const auto is_other = [mark](PixelHint hint) { return is_certain(hint) && hint != mark; };
      if (pure.has_near(x, y, size, kRingingPx, is_other)) leave_out(p);
    }
  reading.forgive_fringes(size, kRingingPx);
}

/// For two pictures of equal size.
PhotoReading read_difference(const RawMask& picture, const RawMask& photo) {
  PhotoReading out{Reading(pixels_of(picture)), 0};
  std::size_t opaque = 0, kept = 0, changed = 0;
  for (std::size_t p = 0; p < out.marks.mark.size(); ++p) {
    if (is_see_through(picture, p)) continue;
    const Colour8 colour = colour_of(picture, p);
    ++opaque;
    const int distance = distance_of(colour, colour_of(photo, p));
    if (distance <= kPaintDistance) {
      ++kept;
      changed += distance > 0;
      continue;
    }
    out.marks.mark[p] = mark_of(colour);
    out.marks.unclear[p] = !is_certain(out.marks.mark[p]);
  }
  out.kept = opaque > 0 ? double(kept) / double(opaque) : 0;
  if (double(changed) > kCompressedShare * double(kept)) leave_out_artefacts(picture, photo, out.marks);
  out.marks.forgive_fringes(size_of(picture));
  return out;
}

/// The pixels of `from` that pixel i of `to` covers, at least one.
std::pair<int, int> covered_pixels(int i, int from, int to) {
  const auto begin = std::int64_t(i) * from / to, end = (std::int64_t(i) + 1) * from / to;
  return {int(begin), int(std::max(begin + 1, end))};
}

std::uint16_t mean_sample(const RawMask& picture, std::pair<int, int> columns, std::pair<int, int> rows, int channel) {
  std::uint64_t sum = 0, count = 0;
  for (int v = rows.first; v < rows.second; ++v)
    for (int u = columns.first; u < columns.second; ++u, ++count)
      sum +=
          picture.data[Reading::index(u, v, size_of(picture)) * std::size_t(picture.channels) + std::size_t(channel)];
  return std::uint16_t((sum + count / 2) / count);
}

/// The average of the samples that a pixel of `size` covers, or the nearest sample.
RawMask scaled(const RawMask& picture, ImageSize size) {
  RawMask out{size.width_px, size.height_px, picture.channels, picture.bits, picture.lossy, {}};
  for (int y = 0; y < size.height_px; ++y)
    for (int x = 0; x < size.width_px; ++x)
      for (int c = 0; c < picture.channels; ++c)
        out.data.push_back(mean_sample(picture, covered_pixels(x, picture.width_px, size.width_px),
                                       covered_pixels(y, picture.height_px, size.height_px), c));
  return out;
}

/// For a picture that was scaled with its paint. Scaling changes pixels at edges, so only nearly pure green and red is
/// paint, where the photo has another colour.
PhotoReading read_scaled(const RawMask& picture, const RawMask& photo) {
  PhotoReading out{Reading(pixels_of(picture)), 0};
  std::size_t opaque = 0, kept = 0;
  for (std::size_t p = 0; p < out.marks.mark.size(); ++p) {
    if (is_see_through(picture, p)) continue;
    const Colour8 colour = colour_of(picture, p), before = colour_of(photo, p);
    const PixelHint mark = mark_of(colour);
    ++opaque;
    if (is_certain(mark) && distance_to_pure(colour, mark) <= kPureDistance &&
        distance_of(colour, before) > 2 * kPaintDistance)
      out.marks.mark[p] = mark;
    else
      kept += distance_of(colour, before) <= 2 * kPaintDistance;
  }
  out.kept = opaque > 0 ? double(kept) / double(opaque) : 0;
  return out;
}

std::string shares_of(const Reading& r) {
  return percent(r.share(PixelHint::kObject)) + " is green, " + percent(r.share(PixelHint::kBackground)) + " red, " +
         percent(r.unclear_share()) + " other colours";
}

[[noreturn]] void refuse(const std::string& path, const std::string& found) {
  throw Error(ErrorCode::kBadInput,
              path + ": " + found +
                  ", expected green (object) and red (background) paint on the view's photo, or such markers alone",
              "paint with pure green (0, 255, 0) and red (255, 0, 0) on a copy of the photo at its full size, or on a "
              "transparent layer that is saved alone");
}

}  // namespace

HandPrompt read_painted_picture(const std::string& path, const std::string& photo) {
  const RawMask picture = read_mask_raw(path, Palette::kColours);
  if (picture.channels < 3)
    throw Error(ErrorCode::kBadInput, path + ": a grey picture, expected green (object) and red (background) strokes",
                "give one picture per side: --object-scribbles PNG --background-scribbles PNG");
  HandPrompt prompt;
  prompt.width_px = picture.width_px;
  prompt.height_px = picture.height_px;
  const ImageSize size = size_of(picture), of_photo = photo.empty() ? size : read_image_size(photo);
  const bool is_scaled = of_photo != size;
  if (is_scaled && relate_sizes(size, of_photo, 1).allowed) {
    PhotoReading over = read_scaled(picture, scaled(read_mask_raw(photo, Palette::kColours), size));
    if (over.kept >= kMinKeptScaled && over.marks.marked() > 0) {
      prompt.painted = std::move(over.marks.mark);
      return prompt;
    }
  }
  if (!photo.empty() && !is_scaled) {
    PhotoReading over = read_difference(picture, read_mask_raw(photo, Palette::kColours));
    if (over.kept >= kMinKept && over.marks.is_clear()) {
      prompt.painted = std::move(over.marks.mark);
      return prompt;
    }
    if (over.kept > 1 - kUnclearShare && over.marks.marked() == 0) refuse(path, "nothing is painted on the photo");
  }
  Reading alone = read_markers(picture);
  const std::string sizes = is_scaled ? ": " + to_string(size) + " px, expected a marked copy of " + photo +
                                            " with its " + to_string(of_photo) + " px"
                                      : "";
  if (is_scaled && !alone.is_clear())
    throw Error(ErrorCode::kBadInput, path + sizes, "paint on a copy at its full size, without cropping it");
  if (alone.marked() == 0) refuse(path, "nothing is marked");
  if (!alone.is_clear()) refuse(path, shares_of(alone));
  prompt.painted = std::move(alone.mark);
  return prompt;
}

}  // namespace ngs::io
