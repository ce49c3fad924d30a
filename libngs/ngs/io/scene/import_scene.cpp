#include "ngs/io/scene/import_scene.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include "ngs/core/error.h"
#include "ngs/core/formatted.h"
#include "ngs/core/parse_number.h"
#include "ngs/io/capture/pose.h"
#include "ngs/io/files/folder_index.h"
#include "ngs/io/files/mapped_file.h"
#include "ngs/io/files/shell_word.h"
#include "ngs/io/files/text_lines.h"
#include "ngs/io/image/annotations.h"
#include "ngs/io/image/image_file.h"
#include "ngs/io/image/mask_names.h"
#include "ngs/io/image/masks.h"
#include "ngs/io/scene/find_model.h"
#include "ngs/io/scene/scene_json.h"
#include "ngs/scene/view_names.h"

namespace ngs::io {
namespace {

namespace fs = std::filesystem;

std::string model_in_folder(const std::string& base, std::vector<std::string>& notes) {
  const ModelSearch found = find_model(base);
  for (const std::string& note : {found.problem, found.unused})
    if (!note.empty()) notes.push_back(note + " (name it with --model PATH)");
  return found.path;
}

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : " ") + name;
  return text;
}

/// Finds the mask folder; `out` has the views and the folder of their photos.
std::string find_masks_dir(const ImportRequest& request, const std::string& base, ImportedScene& out) {
  std::vector<std::string>& notes = out.notes;
  std::error_code ignored;
  std::string usual = usual_masks(base, out.images_dir, out.unfit_masks);
  require_readable_folder(request.masks_dir.empty() ? usual : request.masks_dir);
  if (!request.masks_dir.empty() && is_annotations(request.masks_dir) && is_regular_file(request.masks_dir))
    return request.masks_dir;
  if (is_regular_file(request.masks_dir))
    if (const UnfitMasks unfit = unfit_masks(request.masks_dir, out.scene.views); !unfit.found.empty())
      throw Error(ErrorCode::kBadInput, unfit.found, unfit.remedy);
  if (!request.masks_dir.empty() && !fs::is_directory(request.masks_dir, ignored))
    throw Error(ErrorCode::kBadInput, request.masks_dir + ": no such folder, expected masks");
  if (!request.masks_dir.empty() && request.masks_dir != usual) return request.masks_dir;
  std::vector<std::string> candidates, of_truth;
  for (const std::string& name : list_folders(base)) {
    const std::string lower = lower_case(name);
    if (!is_called_like_masks(lower) || (fs::path(base) / name).generic_string() == usual) continue;
    const bool is_truth = lower.ends_with("_gt") || lower.starts_with("gt");
    (is_truth ? of_truth : candidates).push_back(name);
  }
  if (!usual.empty()) {
    if (!candidates.empty())
      notes.push_back(usual + ": used for masks, not " + joined(candidates) + " (choose another with --masks DIR)");
    return usual;
  }
  if (const char* preferred = "masks_sam"; std::ranges::find(candidates, preferred) != candidates.end())
    candidates = {preferred};
  const bool in_photos = !out.images_dir.empty() && photo_folder_holds_masks(out.images_dir, out.scene.views);
  const bool is_open = std::ranges::any_of(out.scene.views, &std::string::empty, &SceneView::mask_path);
  if (candidates.empty() && is_open && !in_photos) {
    const MaskFolders below = mask_folders_below(base, out.images_dir, out.scene.views);
    candidates = below.by_name;
    for (const std::string& folder : below.by_look)
      notes.push_back(
          (fs::path(base) / folder).generic_string() +
          ": its pictures are called like photos and look like masks, not read (if they are masks: --masks " +
          shell_word((fs::path(base) / folder).generic_string()) + ")");
  }
  if (candidates.size() == 1) {
    std::string chosen = (fs::path(base) / candidates[0]).generic_string();
    notes.push_back(chosen + ": used for masks because of its name (choose another with --masks DIR)");
    return chosen;
  }
  for (const std::string& name : of_truth)
    notes.push_back((fs::path(base) / name).generic_string() +
                    ": not read, its name suggests ground truth (if it holds the input masks: --masks DIR)");
  if (!candidates.empty())
    out.unfit_masks = {base + ": several mask folders (" + joined(candidates) + "), none used",
                       "choose one with --masks DIR"};
  else if (in_photos)
    return out.images_dir;
  return {};
}

std::string find_truth_dir(const ImportRequest& request, const std::string& base) {
  if (!request.truth_dir.empty()) return request.truth_dir;
  const std::string usual = folder_called(base, "masks_gt");
  return usual.empty() ? folder_called(base, "gt") : usual;
}

/// "7" -> {"object-7", 7} with label maps, else {"7", 0}; "cup=7" -> {"cup", 7}; "cup" -> {"cup", 0}.
SceneObject parse_object(const std::string& text, MaskMode mode) {
  const std::size_t equals = text.rfind('=');
  const std::string name = text.substr(0, equals);
  const std::string digits = equals == std::string::npos ? text : text.substr(equals + 1);
  std::uint32_t id = 0;
  const bool has_id = parse_number(digits, id);
  if (equals != std::string::npos && (!has_id || name.empty()))
    throw Error(ErrorCode::kUsage, "--object-id " + text + ": no id after \"=\", expected name=id such as cup=7");
  if (mode != MaskMode::kLabel) return {name, equals == std::string::npos ? 0 : id};
  if (!has_id || id > 65535)
    throw Error(ErrorCode::kUsage, "--object-id " + text + ": no id in 0..65535, expected 7 or cup=7 for label maps");
  return {equals == std::string::npos ? "object-" + digits : name, id};
}

std::vector<SceneObject> objects_in_label_maps(const std::vector<SceneView>& views,
                                               std::optional<std::uint32_t> void_id, std::vector<std::string>& notes) {
  std::set<std::uint32_t> ids;
  for (const SceneView& view : views) {
    if (view.mask_path.empty() || view.split == Split::kHeldOut) continue;
    ids.merge(ids_in_label_map(view.mask_path));
    constexpr std::size_t kMaxObjects = 1024;
    if (ids.size() > kMaxObjects)
      throw Error(ErrorCode::kBadInput, view.mask_path + ": more than 1024 different values, expected a label map",
                  "choose the objects with --object-id, or use --mask-mode soft");
  }
  ids.erase(0);
  if (void_id) ids.erase(*void_id);
  constexpr std::uint32_t kUsualVoid = 255;  // in PASCAL VOC and derived formats
  if (ids.size() > 1 && ids.contains(kUsualVoid))
    notes.push_back("label maps contain id 255 and others; if 255 marks unlabelled pixels: --void-id 255");
  std::vector<SceneObject> objects;
  for (const std::uint32_t id : ids) objects.push_back({"object-" + std::to_string(id), id});
  return objects;
}

/// nerfstudio's mask_path are mostly masks of valid pixels: a folder named by the user replaces them.
void leave_out_masks_of_source(ImportedScene& out) {
  int count = 0;
  for (SceneView& view : out.scene.views)
    if (!view.mask_path.empty()) {
      view.mask_path.clear();
      ++count;
    }
  if (count > 0)
    out.notes.push_back(out.cameras_file + ": mask_path of " + std::to_string(count) +
                        " views ignored, masks are read from " + out.masks_dir);
}

/// Masks in JSON, if no view has an image as mask.
void attach_annotations(const ImportRequest& request, const std::string& base, ImportedScene& out) {
  const AnnotationMatches found =
      match_annotations(annotation_files(request.masks_dir, base, {out.masks_dir, out.images_dir}), out.scene.views);
  if (found.views == 0) return;
  out.views_by_mask_rule["annotations"] = found.views;
  out.scene.mask_mode = MaskMode::kBinary;
  for (const SceneObject& object : out.scene.objects)
    if (std::ranges::find(found.labels, object.name) == found.labels.end())
      throw Error(ErrorCode::kInconsistent, "--object-id " + object.name + ": the annotations have " +
                                                joined(found.labels) + ", expected one of them");
  if (out.scene.objects.empty())
    for (const std::string& label : found.labels) out.scene.objects.push_back({label, 0});
}

bool are_same_bytes(const std::string& a, const std::string& b) {
  std::error_code failed;
  if (!is_regular_file(a) || !is_regular_file(b) || fs::file_size(a, failed) != fs::file_size(b, failed)) return false;
  return std::ranges::equal(map_regular_file(a).bytes(), map_regular_file(b).bytes());
}

/// Whether the alpha channel of a photo can be a mask; false for a file that cannot be read, which is found later.
bool is_cut_out_photo(const std::string& path) {
  try {
    return is_transparent(path) && is_cut_out(read_mask_raw(path, Palette::kColours).samples());
  } catch (const Error&) {
    return false;
  }
}

bool names_photos(const ImportRequest& request, const ImportedScene& out) {
  std::error_code ignored;
  return !request.masks_dir.empty() && fs::equivalent(request.masks_dir, out.images_dir, ignored);
}

/// Masks that are the photos, or copies of them: their alpha channel. It is also used if there are no other masks.
void take_masks_from_photos(const ImportRequest& request, ImportedScene& out, std::vector<std::string>& unmatched) {
  if (request.mask_mode == MaskMode::kLabel) return;
  const bool is_open = out.views_by_mask_rule.empty() && out.unfit_masks.found.empty() &&
                       (request.masks_dir.empty() || names_photos(request, out));
  int in_photos = 0;
  for (SceneView& view : out.scene.views) {
    if (are_same_bytes(view.mask_path, view.image_path) && is_cut_out_photo(view.image_path))
      view.mask_path = view.image_path;
    if (!is_open || view.image_path.empty()) continue;
    const bool is_mask = is_cut_out_photo(view.image_path);
    if (!is_mask && in_photos == 0) return;  // opaque photos: most folders
    if (!is_mask) continue;
    view.mask_path = view.image_path;
    std::erase(unmatched, view.camera.name);
    ++in_photos;
  }
  if (in_photos > 0) out.views_by_mask_rule[kAlphaRule] = in_photos;
}

MaskMatches match_by_request(const ImportRequest& request, ImportedScene& out) {
  std::vector<std::string> names;
  for (const SceneObject& object : out.scene.objects) names.push_back(object.name);
  MaskMatches matches = request.masks_in_order ? pair_masks_in_order(out.masks_dir, out.scene.views)
                                               : match_masks(out.masks_dir, names, out.scene.views);
  std::string folder = out.masks_dir;
  while (!folder.empty() && matches.views_by_rule.empty() && list_images(folder).empty()) {
    std::vector<std::string> only = list_folders(folder);
    std::erase_if(only, [](const std::string& name) { return name.starts_with(".") || is_resource_fork(name); });
    if (only.size() != 1) break;
    folder = (fs::path(folder) / only[0]).generic_string();
    matches = match_masks(folder, names, out.scene.views);
  }
  if (!matches.views_by_rule.empty() && folder != out.masks_dir) {
    out.masks_dir = folder;
    out.notes.push_back(folder + ": read for masks, as the only folder there");
  }
  if (request.mask_shift != 0) shift_masks(request.mask_shift, out.scene.views, matches);
  return matches;
}

void note_matches(const ImportedScene& out, const MaskMatches& matches, std::vector<std::string>& notes) {
  const std::size_t views = out.scene.views.size();
  if (!matches.of_no_view.empty() && out.masks_dir != out.images_dir)
    notes.push_back(out.masks_dir + ": " + std::to_string(matches.of_no_view.size()) +
                    " images match no view (first: " + matches.of_no_view[0] + ")");
  if (matches.unmatched.size() == views && out.masks_dir.empty())
    notes.push_back("no masks");
  else if (!matches.unmatched.empty())
    notes.push_back("no mask for " + std::to_string(matches.unmatched.size()) + " of " + std::to_string(views) +
                    " views (first: " + matches.unmatched[0] + ")");
  if (matches.several > 0)
    notes.push_back(std::to_string(matches.several) + " views have two masks (first: " + matches.taken + " is used, " +
                    matches.not_taken + " is not)");
}

void attach_masks(const ImportRequest& request, const std::string& base, ImportedScene& out) {
  Scene& scene = out.scene;
  if (!request.masks_dir.empty()) leave_out_masks_of_source(out);
  for (const std::string& text : request.object_ids) scene.objects.push_back(parse_object(text, request.mask_mode));
  MaskMatches matches = match_by_request(request, out);
  out.views_by_mask_rule = matches.views_by_rule;
  if (matches.unmatched.size() == scene.views.size()) attach_annotations(request, base, out);
  const bool has_none = matches.unmatched.size() == scene.views.size() && out.views_by_mask_rule.empty();
  if (has_none && !out.masks_dir.empty() && out.masks_dir != out.images_dir && !names_photos(request, out))
    out.unfit_masks = unfit_masks(out.masks_dir, scene.views);
  if (!has_none && !out.unfit_masks.found.empty()) {
    out.notes.push_back(out.unfit_masks.found + " (" + out.unfit_masks.remedy + ")");
    out.unfit_masks = {};
  }
  if (const std::string file = file_of_all_masks(base); has_none && out.masks_dir.empty() && !file.empty())
    out.unfit_masks = unfit_masks(file, scene.views);
  take_masks_from_photos(request, out, matches.unmatched);
  if (has_none && out.views_by_mask_rule.empty()) {
    if (!request.masks_dir.empty())
      throw Error(ErrorCode::kInconsistent,
                  out.unfit_masks.found.empty()
                      ? out.masks_dir + ": no mask of any view (such as " + scene.views[0].camera.name +
                            "), expected names like <stem>.png, <name>.png, <stem>_mask.png "
                            "or <object>/<stem>.png"
                      : out.unfit_masks.found,
                  out.unfit_masks.found.empty() ? "name the masks after their photos" : out.unfit_masks.remedy);
    if (!out.unfit_masks.found.empty()) out.notes.push_back(out.unfit_masks.found + "; " + out.unfit_masks.remedy);
    matches.of_no_view.clear();
  }
  if (!out.views_by_mask_rule.contains("annotations")) note_matches(out, matches, out.notes);
  if (!scene.objects.empty()) return;
  leave_out_pictures(out.masks_dir, scene.views, matches.objects, out.notes);
  for (const std::string& name : matches.objects) scene.objects.push_back({name, 0});
  if (const std::string note = incomplete_masks(scene); !note.empty()) out.notes.push_back(note);
  if (scene.objects.empty() && scene.mask_mode == MaskMode::kLabel)
    scene.objects = objects_in_label_maps(scene.views, scene.void_id, out.notes);
  if (scene.objects.empty()) scene.objects.push_back({});
}

void hold_out_every(const std::string& rule, std::vector<SceneView>& views) {
  const std::optional<EveryRule> every = parse_every(rule);
  if (!every)
    throw Error(ErrorCode::kUsage, "--hold-out " + rule + ": not every:N:K with K < N, expected e.g. every:8:0");
  for (std::size_t i = 0; i < views.size(); ++i)
    if (every->selects(i)) views[i].split = Split::kHeldOut;
}

void hold_out_named(const std::string& path, std::vector<SceneView>& views) {
  const std::vector<std::string> listed = read_name_list(path);
  if (listed.empty()) throw Error(ErrorCode::kBadInput, path + ": names no view, expected image names, one per line");
  const ViewNames names(views);
  for (const std::string& name : listed) {
    const std::vector<std::size_t> found = names.find(name);
    if (found.size() != 1)
      throw Error(ErrorCode::kInconsistent, path + ": " + name + " is " +
                                                (found.empty() ? "no view" : "several views") +
                                                ", expected image names, one per line");
    views[found[0]].split = Split::kHeldOut;
  }
}

/// The smallest image scale, rounded up, at which the photos' shortest side has that many pixels.
std::string least_scale(int side_px, int shortest_px) {
  return formatted("%.3f", std::min(1.0, std::ceil(1000.0 * side_px / shortest_px) / 1000));
}

}  // namespace

void assign_splits(const std::string& hold_out, std::vector<SceneView>& views) {
  if (hold_out.empty()) return;
  if (hold_out.rfind("every:", 0) == 0)
    hold_out_every(hold_out, views);
  else
    hold_out_named(hold_out, views);
  const auto held = std::ranges::count(views, Split::kHeldOut, &SceneView::split);
  if (held == std::ssize(views))
    throw Error(ErrorCode::kInconsistent,
                "--hold-out " + hold_out + ": holds out every view, expected some to train on");
  if (held == 0)
    throw Error(
        ErrorCode::kInconsistent,
        "--hold-out " + hold_out + ": holds out none of the " + std::to_string(views.size()) + " views, expected some",
        "leave it out to train on all");
}

/// The largest 1/k at which no photo's longer side exceeds kWorkingSizePx. All views use the same scale: small photos
/// of a mixed capture are reduced unnecessarily, with a note.
double automatic_scale(const std::vector<SceneView>& views, std::vector<std::string>& notes) {
  const auto side = [](const SceneView& view) { return std::max(view.camera.width_px, view.camera.height_px); };
  int longest = 1;
  for (const SceneView& view : views) longest = std::max(longest, side(view));
  const int k = (longest + kWorkingSizePx - 1) / kWorkingSizePx;
  const auto small = std::count_if(views.begin(), views.end(),
                                   [&](const SceneView& view) { return k > 1 && side(view) <= kWorkingSizePx; });
  if (small > 0)
    notes.push_back(std::to_string(small) + " views of at most " + std::to_string(kWorkingSizePx) +
                    " px are reduced to 1/" + std::to_string(k) + " of their size too, because the largest has " +
                    std::to_string(longest) + " px; --image-scale 1 keeps all at full size");
  return 1.0 / k;
}

ImportedScene import_scene(const ImportRequest& request) {
  CaptureSource source = read_capture(request.capture);
  ImportedScene out;
  out.format = source.capture.format;
  out.notes = source.capture.notes;
  out.cameras_file = source.file;
  out.images_dir = source.images_dir;
  Scene& scene = out.scene;
  if (source.rendered) {
    scene = *source.rendered;
    scene.objects.clear();
  }
  const double rendered_scale = scene.image_scale;
  scene.views = std::move(source.capture.views);
  if (!request.model_path.empty())
    scene.model_path = request.model_path;
  else if (!source.rendered)
    scene.model_path = model_in_folder(source.base, out.notes);
  if (const std::string settings = antialiasing_settings(scene.model_path); !settings.empty() && !scene.antialiased) {
    scene.antialiased = true;
    out.notes.push_back(settings + ": the model was trained with antialiasing (if not: --antialias off)");
  }
  scene.mask_mode = request.mask_mode;
  scene.mask_invert = request.mask_invert;
  scene.mask_threshold = request.mask_threshold;
  scene.missing_mask = request.missing_mask;
  scene.void_id = request.void_id;
  scene.image_scale = request.image_scale > 0 ? request.image_scale : automatic_scale(scene.views, out.notes);
  if (source.rendered) {  // keeps the filter's angular size
    const double finer = scene.image_scale / rendered_scale;
    scene.filter_px2 *= finer * finer;
  }
  if (const UnfitMasks lost = leave_out_lost_masks(scene.views); !lost.found.empty()) out.unfit_masks = lost;
  out.masks_dir = find_masks_dir(request, source.base, out);
  out.truth_dir = find_truth_dir(request, source.base);
  assign_splits(request.hold_out, scene.views);
  attach_masks(request, source.base, out);
  int shortest_px = kMaxSide;
  for (SceneView& view : scene.views) {
    shortest_px = std::min({shortest_px, view.camera.width_px, view.camera.height_px});
    view.camera = resized(view.camera, scaled_size_px(view.camera.width_px, scene.image_scale),
                          scaled_size_px(view.camera.height_px, scene.image_scale));
  }
  constexpr int kMinSide_px = 8;  // smaller images cannot tell models apart
  for (const SceneView& view : scene.views)
    if (const Camera& c = view.camera; scene.image_scale < 1 && std::min(c.width_px, c.height_px) < kMinSide_px)
      throw Error(ErrorCode::kUsage,
                  "--image-scale " + std::to_string(scene.image_scale) + ": view " + c.name + " becomes " +
                      std::to_string(c.width_px) + "x" + std::to_string(c.height_px) + " px, expected at least " +
                      std::to_string(kMinSide_px) + " a side",
                  "--image-scale " + least_scale(kMinSide_px, shortest_px) + " or more keeps that of every view");
  validate_scene(scene, request.capture.source);
  return out;
}

}  // namespace ngs::io
