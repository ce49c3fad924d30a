#include "ngs/io/image/masks.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "ngs/core/check.h"
#include "ngs/core/error.h"
#include "ngs/core/folded_name.h"
#include "ngs/io/files/shell_word.h"
#include "ngs/io/image/annotations.h"
#include "ngs/io/image/exr.h"
#include "ngs/io/image/image_file.h"
#include "ngs/io/image/size_rule.h"
#include "ngs/scene/mask_samples.h"
#include "ngs/scene/mask_threshold.h"

namespace ngs::io {
namespace {

constexpr float kBandSegment = 128, kBandKeep = 250;  // on the 8-bit scale
constexpr const char* kObjectField = "{object}";

/// One file as single-channel samples, before interpretation.
struct Plane {
  ImageF value;          // [H, W, 1] as in the file
  float full_scale = 1;  // of the sample type: 255, 65535, or 1
  bool lossy = false;
  float used_scale = full_scale;  // of the values in use, see DecisiveSamples
};

/// One file interpreted at its own size.
struct Decoded {
  std::vector<ImageF> target;  // one per object in the file, [H, W, 1]; empty while only `ids` is set
  ImageF ids;                  // label maps, [H, W, 1]
  ImageF known;                // [H, W, 1]; empty: all pixels are known
  bool lossy = false;
};

/// The first of these channels that exists, else the only channel of the file, [H, W, 1].
ImageF read_exr_channel(const std::string& path, const std::vector<std::string>& preferred) {
  ExrImage exr = read_exr(path);
  const auto name = std::find_if(preferred.begin(), preferred.end(),
                                 [&](const std::string& candidate) { return exr.channels.count(candidate) != 0; });
  if (name == preferred.end() && exr.channels.size() != 1)
    throw Error(ErrorCode::kBadInput,
                path + ": EXR without a channel " + preferred[0] + ", Y or R, expected one of them");
  ImageF plane;
  plane.width_px = exr.width_px;
  plane.height_px = exr.height_px;
  plane.channels = 1;
  plane.data = std::move(name != preferred.end() ? exr.channels.at(*name) : exr.channels.begin()->second);
  return plane;
}

[[noreturn]] void refuse_value(const std::string& path, float value, const char* expected) {
  throw Error(ErrorCode::kBadInput, path + ": mask value " + std::to_string(value) + ", expected " + expected);
}

Plane read_exr_plane(const std::string& path, MaskMode mode) {
  Plane plane;
  if (mode == MaskMode::kLabel) {
    plane.value = read_id_exr(path);
    return plane;
  }
  plane.value = read_exr_channel(path, {"ngs.mask", "A", "Y", "R"});
  for (const float v : plane.value.data)
    if (!(v >= 0.f && v <= 1.f)) refuse_value(path, v, "[0, 1]");
  return plane;
}

Plane read_plane(const std::string& path, MaskMode mode, std::vector<std::string>& notes) {
  if (is_exr(path)) return read_exr_plane(path, mode);
  const RawMask raw = read_mask_raw(path, mode == MaskMode::kLabel ? Palette::kIndices : Palette::kMask);
  Plane plane{ImageF(raw.width_px, raw.height_px, 1), raw.bits == 8 ? 255.f : 65535.f, raw.lossy};
  const MaskSamples samples = raw.samples();
  const bool is_label_map = mode == MaskMode::kLabel, cut_out = is_cut_out(samples) && !is_label_map;
  if (!cut_out && !is_grey(samples)) {
    if (is_label_map)
      throw Error(ErrorCode::kBadInput, path + ": colour image, expected a label map with one id per pixel",
                  "save the ids themselves (8 or 16 bit grey, or a palette PNG), not their colours");
    const ImageKind kind = image_kind(samples);
    if (kind == ImageKind::kPhoto)
      throw Error(ErrorCode::kBadInput, path + ": a picture of many colours, expected a mask: an object in one colour",
                  "save the masks themselves, not the photos or pictures with the mask drawn on them");
    notes.push_back(
        path +
        (kind == ImageKind::kPhotoOnOneColour ? ": a picture on one colour, read as object where it has another"
         : has_several_colours(samples)
             ? ": several colours, all bright ones read as one object (of a map of objects, save ids: --mask-mode "
               "label)"
             : ": colour image, the largest of red, green and blue (or the one that differs most) used as the mask"));
  }
  if (!cut_out && !is_label_map && is_grey(samples) && has_many_greys(samples))
    notes.push_back(path + ": many greys, as in a picture of depth: read as object where they are bright");
  if (cut_out) notes.push_back(path + ": alpha channel used as the mask");
  if (is_label_map)
    for (std::size_t i = 0; i < plane.value.data.size(); ++i)
      plane.value.data[i] = float(raw.data[i * std::size_t(raw.channels)]);
  else {
    const DecisiveSamples decisive = decisive_samples(samples);
    std::ranges::copy(decisive.value, plane.value.data.begin());
    plane.used_scale = decisive.full_scale;
  }
  return plane;
}

/// Recognises such files: at the scale of their sample type they would be all background.
void take_used_scale(Plane& plane, const std::string& path, std::vector<std::string>& notes) {
  if (plane.used_scale == plane.full_scale) return;
  plane.full_scale = plane.used_scale;
  notes.push_back(path + ": values are 0 and " + std::to_string(int(plane.used_scale)) +
                  " only, read as background and object");
}

/// The middle value of a trimap, which means unknown; -1: another mask. No background touches its object, as it does
/// where two objects are saved as 128 and 255.
float unknown_of_trimap(const Plane& plane) {
  const float full = plane.full_scale;
  const ImageF& value = plane.value;
  float middle = -1;
  bool has_object = false;
  for (const float v : value.data) {
    has_object |= v == full;
    if (v == 0 || v == full || v == middle) continue;
    if (middle >= 0 || v < 0.45f * full || v > 0.55f * full) return -1;
    middle = v;
  }
  if (!has_object || middle < 0) return -1;
  for (int y = 0; y < value.height_px; ++y)
    for (int x = 0; x < value.width_px; ++x) {
      const float v = value.at(x, y);
      if (x > 0 && std::abs(v - value.at(x - 1, y)) == full) return -1;
      if (y > 0 && std::abs(v - value.at(x, y - 1)) == full) return -1;
    }
  return middle;
}

template <class Rule>
ImageF mapped(const ImageF& from, const Rule& rule) {
  ImageF out(from.width_px, from.height_px, 1);
  std::transform(from.data.begin(), from.data.end(), out.data.begin(), rule);
  return out;
}

/// 0 at the unknown pixels of a trimap, else 1; empty for other masks.
ImageF known_of_trimap(const Plane& plane, const std::string& path, std::vector<std::string>& notes) {
  const float unknown = unknown_of_trimap(plane);
  if (unknown < 0) return {};
  notes.push_back(path + ": a trimap, its middle value read as unknown");
  return mapped(plane.value, [&](float v) { return v == unknown ? 0.f : 1.f; });
}

Decoded decode(const Scene& scene, const std::string& path, std::vector<std::string>& notes) {
  Plane plane = read_plane(path, scene.mask_mode, notes);
  const float object = scene.mask_invert ? 0.f : 1.f;
  Decoded out;
  out.lossy = plane.lossy;
  switch (scene.mask_mode) {
    case MaskMode::kBinary: {
      take_used_scale(plane, path, notes);
      // {0,1} files have a threshold of their own; EXR and 16 bit use the 8-bit scale
      const double threshold =
          plane.full_scale == 1.f && !is_exr(path) ? 1.0 : scene.mask_threshold / 255.0 * double(plane.full_scale);
      out.target.push_back(mapped(plane.value, [&](float v) { return double(v) >= threshold ? object : 1 - object; }));
      out.known = known_of_trimap(plane, path, notes);
      break;
    }
    case MaskMode::kSoft:
      take_used_scale(plane, path, notes);
      out.target.push_back(mapped(plane.value, [&](float v) {
        const float soft = v / plane.full_scale;
        return scene.mask_invert ? 1 - soft : soft;
      }));
      break;
    case MaskMode::kBands: {
      const float scale = plane.full_scale / 255.f;
      out.target.push_back(mapped(plane.value, [&](float v) {
        return v < kBandSegment * scale ? 0.f : v > kBandKeep * scale ? object : 1 - object;
      }));
      out.known = mapped(plane.value, [&](float v) { return v < kBandSegment * scale ? 0.f : 1.f; });
      break;
    }
    case MaskMode::kLabel:
      if (scene.void_id)
        out.known = mapped(plane.value, [&](float v) { return v == float(*scene.void_id) ? 0.f : 1.f; });
      out.ids = std::move(plane.value);
      break;
  }
  return out;
}

/// Area shares -> the class with the largest share of the known area. In ties objects come first, background last.
void take_majority(const ImageF& known, std::vector<ImageF>& share) {
  for (std::size_t i = 0; i < share[0].data.size(); ++i) {
    float background = known.empty() ? 1 : known.data[i];
    std::size_t best = 0;
    for (std::size_t k = 0; k < share.size(); ++k) {
      background -= share[k].data[i];
      if (share[k].data[i] > share[best].data[i]) best = k;
    }
    // Shares are sums of 1/k² terms: without a tolerance 8 of 16 pixels may sum to less than one half.
    constexpr float kRounding = 1e-5f;
    const bool object_wins = share[best].data[i] >= background - kRounding;
    for (std::size_t k = 0; k < share.size(); ++k) share[k].data[i] = object_wins && k == best ? 1.f : 0.f;
  }
}

void split_ids(const Scene& scene, Decoded& mask) {
  for (const SceneObject& o : scene.objects)
    mask.target.push_back(mapped(mask.ids, [&](float v) { return v == float(o.id) ? 1.f : 0.f; }));
}

/// Object index of every id up to the largest in the scene; -1: none. Empty if two objects have the same id or an id
/// exceeds the range of label maps.
std::vector<int> objects_by_id(const Scene& scene) {
  std::uint32_t largest = 0;
  for (const SceneObject& o : scene.objects) largest = std::max(largest, std::uint32_t(o.id));
  constexpr std::uint32_t kLargestId = 65535;
  if (largest > kLargestId) return {};
  std::vector<int> object(std::size_t(largest) + 1, -1);
  for (std::size_t k = 0; k < scene.objects.size(); ++k) {
    int& of_id = object[std::size_t(scene.objects[k].id)];
    if (of_id >= 0) return {};
    of_id = int(k);
  }
  return object;
}

/// The object that take_majority() would choose for a cell of `scale` x `scale` pixels of a label map; -1: none.
int majority_of(const float* ids, int row_px, int scale, const std::vector<int>& object, std::vector<int>& count) {
  const auto object_of = [&](float id) { return id < float(object.size()) ? object[std::size_t(id)] : -1; };
  const int first = object_of(ids[0]);
  bool even = true;
  for (int y = 0; y < scale; ++y)
    for (int x = 0; x < scale; ++x) even &= ids[std::ptrdiff_t(y) * row_px + x] == ids[0];
  if (even) return first;
  std::ranges::fill(count, 0);
  int none = 0;
  for (int y = 0; y < scale; ++y)
    for (int x = 0; x < scale; ++x) {
      const int k = object_of(ids[std::ptrdiff_t(y) * row_px + x]);
      ++(k < 0 ? none : count[std::size_t(k)]);
    }
  const auto most = std::ranges::max_element(count);
  return *most >= none ? int(most - count.begin()) : -1;
}

/// Fast path for label maps exactly 2 or 4 times the target size, where area shares are exact in float. The result
/// equals split_ids(), resize_area() and take_majority() without full-size planes per object. False: not applicable.
bool reduce_ids(const Scene& scene, const ImageSize& wanted, Decoded& mask) {
  const int scale = mask.ids.width_px / wanted.width_px;
  const std::vector<int> object = objects_by_id(scene);
  if ((scale != 2 && scale != 4) || mask.ids.width_px != scale * wanted.width_px ||
      mask.ids.height_px != scale * wanted.height_px || !mask.known.empty() || object.empty())
    return false;
  mask.target.assign(scene.objects.size(), ImageF(wanted.width_px, wanted.height_px, 1));
  std::vector<int> count(scene.objects.size());
  for (int y = 0; y < wanted.height_px; ++y)
    for (int x = 0; x < wanted.width_px; ++x) {
      const float* cell = &mask.ids.data[mask.ids.index(x * scale, y * scale)];
      const int k = majority_of(cell, mask.ids.width_px, scale, object, count);
      if (k >= 0) mask.target[std::size_t(k)].at(x, y) = 1.f;
    }
  return true;
}

/// How to bring masks of another shape than the photos to theirs.
std::string remedy_for_shape(const ImageSize& file, const std::string& path, const ImageSize& wanted,
                             double image_scale) {
  const std::filesystem::path named(path);
  const std::string files = " " + shell_word(named.parent_path().generic_string()) + "/*" + named.extension().string();
  if (is_turned(file, wanted, image_scale))
    return "turn the masks to the photos' stored pixels, their program applied the EXIF orientation: mogrify -rotate "
           "90" +
           files + " (or -rotate -90)";
  const double ratio = double(wanted.height_px) / wanted.width_px;
  const ImageSize by_width{file.width_px, int(std::lround(file.width_px * ratio))},
      by_height{int(std::lround(file.height_px / ratio)), file.height_px};
  const bool is_square = file.width_px == file.height_px, is_wide = by_width.height_px < file.height_px;
  if (is_square) {
    const std::string size = to_string(is_wide ? by_width : by_height);
    return "if their program squeezed the photos: mogrify -resize '" + size + "!'" + files +
           "; if it padded them below or at the right: mogrify -crop " + size + "+0+0 +repage" + files;
  }
  return "make the masks from the photos that the scene names, or import with their folder as --images; if their "
         "program cropped the photos around the middle: mogrify -gravity center -background black -extent " +
         to_string(is_wide ? by_height : by_width) + files;
}

/// Throws kInconsistent for a file that does not show the camera's image.
SizeRelation checked_size(const ImageSize& file, const std::string& path, const Camera& camera, double image_scale) {
  const ImageSize wanted{camera.width_px, camera.height_px};
  const SizeRelation relation = relate_mask_size(file, wanted, image_scale);
  if (relation.same || relation.allowed) return relation;
  throw Error(ErrorCode::kInconsistent,
              path + ": mask of " + to_string(file) + " px for view " + camera.name + " of " + to_string(wanted) +
                  " px, expected the same size or the same shape",
              remedy_for_shape(file, path, wanted, image_scale));
}

void bring_to_size(const Scene& scene, const Camera& camera, const std::string& path, Decoded& mask, LoadedMasks& out) {
  const ImageF& as_read = mask.ids.empty() ? mask.target[0] : mask.ids;
  const ImageSize file{as_read.width_px, as_read.height_px};
  const ImageSize wanted{camera.width_px, camera.height_px};
  const SizeRelation relation = checked_size(file, path, camera, scene.image_scale);
  if (relation.same && !mask.ids.empty()) split_ids(scene, mask);
  if (relation.same) return;
  out.resized = true;
  out.notes.push_back(path + ": mask of " + to_string(file) + " px resampled to the camera's " + to_string(wanted) +
                      " px");
  if (!mask.ids.empty() && relation.larger && reduce_ids(scene, wanted, mask)) return;
  if (!mask.ids.empty()) split_ids(scene, mask);
  const auto resize = relation.larger ? resize_area : resize_nearest;
  for (ImageF& target : mask.target) target = resize(target, wanted.width_px, wanted.height_px);
  if (!mask.known.empty()) mask.known = resize(mask.known, wanted.width_px, wanted.height_px);
  if (scene.mask_mode != MaskMode::kSoft) take_majority(mask.known, mask.target);
  for (float& v : mask.known.data) v = is_set(v) ? 1.f : 0.f;
}

void append(Decoded&& mask, ViewMasks& masks) {
  for (ImageF& target : mask.target) masks.target.push_back(std::move(target.data));
  if (mask.known.empty()) return;
  if (masks.known.empty()) masks.known.assign(mask.known.data.size(), 1);
  for (std::size_t i = 0; i < masks.known.size(); ++i) masks.known[i] &= std::uint8_t(mask.known.data[i] != 0.f);
}

bool is_per_object(const SceneView& view) { return view.mask_path.find(kObjectField) != std::string::npos; }

/// Whether the view counts as having no masks, as scene.missing_mask defines it.
bool is_absent(const Scene& scene, const SceneView& view, const std::vector<std::string>& files) {
  const auto exists = [](const std::string& file) { return std::filesystem::exists(file); };
  const bool complete = !files.empty() && (!is_per_object(view) || std::all_of(files.begin(), files.end(), exists));
  if (complete || scene.missing_mask == MissingMask::kEmpty) return false;
  if (scene.missing_mask == MissingMask::kError)
    throw Error(ErrorCode::kInconsistent, "view " + view.camera.name + ": no mask, expected one for every view",
                "add the mask, or use --missing-mask unknown (no evidence) or empty (object not visible)");
  return true;
}

}  // namespace

bool is_exr(const std::string& path) { return lower_case(std::filesystem::path(path).extension().string()) == ".exr"; }

ImageF read_id_exr(const std::string& path) {
  ImageF ids = read_exr_channel(path, {"ngs.id", "Y", "R"});
  constexpr float kLargestId = 65535.f;
  for (const float v : ids.data)
    if (!(v >= 0.f && v <= kLargestId && v == std::floor(v))) refuse_value(path, v, "ids in 0..65535");
  return ids;
}

std::vector<std::string> mask_files(const Scene& scene, std::size_t view) {
  const std::string& path = scene.views.at(view).mask_path;
  if (path.empty()) return {};
  const std::size_t at = path.find(kObjectField);
  if (at == std::string::npos) return {path};
  std::vector<std::string> files;
  for (const SceneObject& object : scene.objects)
    files.push_back(std::string(path).replace(at, std::string(kObjectField).size(), object.name));
  return files;
}

LoadedMasks load_masks_with_notes(const Scene& scene, std::size_t view) {
  NGS_CHECK(view < scene.views.size(), "view index");
  const SceneView& v = scene.views[view];
  LoadedMasks out;
  out.masks.width_px = v.camera.width_px;
  out.masks.height_px = v.camera.height_px;
  const std::vector<std::string> files = mask_files(scene, view);
  if (is_absent(scene, v, files)) return out;
  out.masks.available = true;
  const std::size_t pixels = std::size_t(v.camera.width_px) * std::size_t(v.camera.height_px);
  const bool per_object = is_per_object(v);
  for (const std::string& file : files) {
    if (per_object && !std::filesystem::exists(file)) {
      out.masks.target.emplace_back(pixels, 0.f);
      continue;
    }
    Decoded mask;
    if (is_annotations(file))
      mask.target = read_annotations(file, v.camera.name, scene.objects);
    else
      mask = decode(scene, file, out.notes);
    bring_to_size(scene, v.camera, file, mask, out);
    out.lossy |= mask.lossy;
    append(std::move(mask), out.masks);
  }
  if (files.empty()) out.masks.target.assign(scene.objects.size(), std::vector<float>(pixels, 0.f));
  NGS_CHECK(out.masks.target.size() == scene.objects.size(), "one mask plane per object");
  return out;
}

std::set<std::uint32_t> ids_in_label_map(const std::string& path) {
  std::vector<std::string> notes;
  const Plane plane = read_plane(path, MaskMode::kLabel, notes);
  std::set<std::uint32_t> ids;
  float last = -1;
  for (const float v : plane.value.data) {
    if (v != last) ids.insert(std::uint32_t(v));  // neighbouring ids are mostly equal
    last = v;
  }
  return ids;
}

ImageU16 read_label_map(const std::string& path, const Camera& camera, double image_scale) {
  std::vector<std::string> notes;
  const Plane plane = read_plane(path, MaskMode::kLabel, notes);
  checked_size({plane.value.width_px, plane.value.height_px}, path, camera, image_scale);
  ImageU16 ids(plane.value.width_px, plane.value.height_px, 1);
  std::ranges::copy(plane.value.data, ids.data.begin());
  return ids;
}

ViewMasks load_masks(const Scene& scene, std::size_t view) { return load_masks_with_notes(scene, view).masks; }

}  // namespace ngs::io
