#include "ngs/io/scene/unfit_masks.h"

#include <algorithm>
#include <filesystem>
#include <set>

#include "ngs/core/error.h"
#include "ngs/core/folded_name.h"
#include "ngs/core/listed.h"
#include "ngs/io/files/folder_index.h"
#include "ngs/io/files/mapped_file.h"
#include "ngs/io/files/shell_word.h"
#include "ngs/io/image/annotations.h"
#include "ngs/io/image/image_file.h"
#include "ngs/io/image/masks.h"
#include "ngs/scene/view_names.h"

namespace ngs::io {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxDepth = 4;  // of folders in the folder of masks, or of a capture
constexpr std::size_t kMaxFiles = 100000;

/// Sorted paths of regular files in the folder and its sub-folders.
std::vector<std::string> files_below(const std::string& folder) {
  std::vector<std::string> files;
  std::error_code failed;
  for (fs::recursive_directory_iterator entry(folder, failed), end; !failed && entry != end; entry.increment(failed)) {
    if (entry.depth() >= kMaxDepth) entry.disable_recursion_pending();
    const std::string path = entry->path().generic_string();
    if (entry->path().filename().string().starts_with(".")) continue;  // of the system or an editor
    if (files.size() < kMaxFiles && is_regular_file(path)) files.push_back(path);
  }
  std::ranges::sort(files);
  return files;
}

std::string ending_of(const std::string& path) { return lower_case(fs::path(path).extension().string()); }

bool is_array(const std::string& path) {
  static const std::set<std::string> endings{".npy", ".npz", ".pt", ".pth", ".pkl", ".mat", ".h5", ".hdf5"};
  return endings.contains(ending_of(path));
}

bool is_film(const std::string& path) {
  static const std::set<std::string> endings{".mp4", ".mov", ".avi", ".mkv", ".webm", ".m4v", ".gif"};
  return endings.contains(ending_of(path));
}

/// The command that unpacks an archive into `folder`; empty: another file.
std::string unpack_command(const std::string& path, const std::string& folder) {
  const std::string ending = ending_of(path), file = shell_word(path), to = shell_word(folder);
  if (ending == ".zip") return "unzip " + file + " -d " + to;
  if (ending == ".7z" || ending == ".rar") return "7z x " + file + " -o" + to;
  const bool is_tar = ending == ".tar" || ending == ".tgz" || lower_case(path).find(".tar.") != std::string::npos;
  return is_tar ? "mkdir -p " + to + " && tar -xf " + file + " -C " + to : "";
}

/// An image in the folder that is called like a view; empty: none.
std::string image_like_view(const std::string& folder, const std::vector<SceneView>& views) {
  const FolderIndex index(folder);
  for (const SceneView& view : views)
    if (std::string found = index.find_stem(bare_name(view.camera.name)); !found.empty()) return found;
  return {};
}

/// A folder for each photo, as SAM's automatic mask generator writes.
bool has_folder_per_photo(const std::string& folder, const std::vector<SceneView>& views) {
  std::set<std::string> stems;
  for (const SceneView& view : views) stems.insert(image_stem(bare_name(view.camera.name)));
  const std::vector<std::string> folders = list_folders(folder);
  return !folders.empty() &&
         std::ranges::all_of(folders, [&](const std::string& name) { return stems.contains(name); });
}

std::string remedy_of_images(const std::string& folder, const std::vector<std::string>& images,
                             const std::vector<SceneView>& views) {
  const std::string place = fs::path(images[0]).parent_path().generic_string();
  const bool is_deeper =
      place != fs::path(folder).generic_string() && std::ranges::all_of(images, [&](const std::string& image) {
        return fs::path(image).parent_path().generic_string() == place;
      });
  if (is_deeper && !image_like_view(place, views).empty()) return "name their folder: --masks " + shell_word(place);
  std::string named = "name each mask after its photo, such as " +
                      (fs::path(folder) / image_stem(views[0].camera.name)).generic_string() + ".png";
  if (has_folder_per_photo(folder, views) && images.size() == list_folders(folder).size())
    return "each folder holds one image, move it: for d in " + shell_word(folder) + "/*/; do mv \"$d\"* \"${d%/}" +
           fs::path(images[0]).extension().string() + "\"; done";
  if (has_folder_per_photo(folder, views))
    return "a folder for each photo holds masks of everything in it, as SAM writes without a prompt: copy the one of "
           "the object; " +
           named;
  if (images.size() != views.size()) return named;
  return "if they are in the order of the photos: " + (is_deeper ? "--masks " + shell_word(place) + " " : "") +
         "--masks-in-order; else " + named;
}

/// One mask for all photos marks the object in one of them.
std::string remedy_of_one(const std::string& path, const SceneView& view) {
  const std::string paint = shell_word(image_stem(bare_name(view.camera.name)) + ".png");
  return "it is the mask of one photo; if of " + view.camera.name + ": convert " + shell_word(path) +
         " -threshold 50% -fill lime -opaque white -transparent black " + paint + "; then --strokes " + paint;
}

bool can_have_pages(const std::string& path) {
  const std::string ending = ending_of(path);
  return ending.starts_with(".tif") || ending == ".gif" || ending == ".webp";
}

/// One file with a mask for each photo: `extract` makes pictures of `file` in the folder masks-png.
std::string remedy_of_stack(const std::string& extract) {
  return "it may hold a mask for each photo: mkdir masks-png; " + extract +
         "; if they are in the order of the photos: --masks masks-png --masks-in-order";
}

std::string remedy_of_arrays(const std::string& folder, const std::vector<std::string>& arrays,
                             const std::vector<SceneView>& views) {
  // logits and ids: above 0; probabilities: above one half
  const std::string object = "(m.squeeze() > (m.dtype.kind == 'f' and m.min() >= 0 and m.max() <= 1) / 2)";
  const std::string convert = "(" + object + ".astype('u1') * 255)", ending = ending_of(arrays[0]);
  const std::string& first = arrays[0];
  std::string save = "arrays are not read: save each as PNG, 255 where the object is";
  const bool is_of_one_view = std::ranges::any_of(
      views,
      [&, stem = fs::path(first).stem().string()](const SceneView& v) { return image_stem(v.camera.name) == stem; });
  if (arrays.size() == 1 && !is_of_one_view && (ending == ".npy" || ending == ".npz"))
    return remedy_of_stack(
        "python3 -c \"import sys, numpy; from PIL import Image; d = numpy.load(sys.argv[1]); "
        "a = d if hasattr(d, 'ndim') else d[d.files[0]] if len(d.files) < 2 else [d[k] for k in d.files]; "
        "[Image.fromarray(" +
        convert + ").save('masks-png/%04d.png' % i) for i, m in enumerate(a)]\" " + shell_word(first));
  if (ending != ".npy" && ending != ".npz") return save;
  return save + ": cd " + shell_word(folder) +
         " && python3 -c \"import glob, numpy; from PIL import Image; "
         "read = lambda d: d if hasattr(d, 'ndim') else "
         "d[d.files[0]]; [Image.fromarray" +
         convert + ".save(f[:-4] + '.png') for f in glob.glob('**/*" + ending +
         "', recursive=True) for m in [read(numpy.load(f))]]\"";
}

/// Links in the folder and its sub-folders that lead to no file.
std::vector<std::string> lost_links(const std::string& folder) {
  std::vector<std::string> links;
  std::error_code failed, ignored;
  for (fs::recursive_directory_iterator entry(folder, failed), end; !failed && entry != end; entry.increment(failed))
    if (entry->is_symlink(ignored) && !fs::exists(entry->path(), ignored) && links.size() < kMaxFiles)
      links.push_back(entry->path().generic_string());
  std::ranges::sort(links);
  return links;
}

/// Whether a picture is grey with few values, as masks and maps of ids are, and photos and depth are not.
bool looks_like_mask(const std::string& path) {
  constexpr std::size_t kFewValues = 32;
  try {
    const RawMask raw = read_mask_raw(path, Palette::kIndices);
    const std::set<std::uint16_t> values(raw.data.begin(), raw.data.end());
    return values.size() <= kFewValues && is_grey(raw.samples());
  } catch (const Error&) {
    return false;
  }
}

struct FolderSearch {
  const std::string base, photos;
  const std::vector<SceneView>& views;
  std::size_t left = 500;  // folders
  MaskFolders found = {};

  void run(const fs::path& below, int levels) {
    for (const std::string& name : list_folders((base / below).string())) {
      const fs::path relative = below / name, path = base / relative;
      const std::string lower = lower_case(name);
      std::error_code ignored;
      const bool is_result = fs::exists(path / ".ngs-cut", ignored) || fs::exists(path / "scene.json", ignored);
      const bool is_truth = lower.ends_with("_gt") || lower.starts_with("gt");
      if (left == 0 || name.starts_with(".") || is_result || is_truth || fs::is_symlink(path, ignored)) continue;
      --left;
      const std::string image = fs::equivalent(path, photos, ignored) ? "" : image_like_view(path.string(), views);
      if (is_called_like_masks(lower)) {
        bool holds_masks = !image.empty();
        for (const std::string& object : list_folders(path.string()))
          holds_masks |= !image_like_view((path / object).string(), views).empty();
        if (holds_masks) found.by_name.push_back(relative.generic_string());
        continue;
      }
      if (!image.empty() && looks_like_mask(image)) found.by_look.push_back(relative.generic_string());
      if (levels > 1) run(relative, levels - 1);
    }
  }
};

}  // namespace

UnfitMasks leave_out_lost_masks(std::vector<SceneView>& views) {
  std::vector<std::string> lost;
  for (SceneView& view : views) {
    if (view.mask_path.empty() || is_regular_file(view.mask_path)) continue;
    lost.push_back(view.mask_path);
    view.mask_path.clear();
  }
  if (lost.empty()) return {};
  return {"mask_path of " + std::to_string(lost.size()) + " views is no file (first: " + lost[0] + "), expected masks",
          "put them there, or name their folder: --masks DIR"};
}

void leave_out_pictures(const std::string& folder, const std::vector<SceneView>& views,
                        std::vector<std::string>& objects, std::vector<std::string>& notes) {
  const auto is_picture = [&](const std::string& object) {
    const std::string path = image_like_view((fs::path(folder) / object).generic_string(), views);
    if (path.empty() || is_exr(path)) return false;
    const RawMask raw = read_mask_raw(path, Palette::kMask);
    return !is_cut_out(raw.samples()) && !is_grey(raw.samples()) && image_kind(raw.samples()) == ImageKind::kPhoto;
  };
  std::vector<std::string> masks;
  std::remove_copy_if(objects.begin(), objects.end(), std::back_inserter(masks), is_picture);
  if (masks.empty() || masks.size() == objects.size()) return;
  notes.push_back(folder + ": only " + ngs::listed(masks, 4) + (masks.size() > 1 ? " hold" : " holds") +
                  " masks, not " + std::to_string(objects.size() - masks.size()) + " folders of pictures next to it");
  objects = std::move(masks);
}

std::string incomplete_masks(const Scene& scene) {
  if (scene.missing_mask != MissingMask::kUnknown || scene.objects.size() < 2) return {};
  std::size_t count = 0, with_masks = 0;
  bool are_parts = true;  // no view has masks of two objects
  std::string first;
  for (std::size_t v = 0; v < scene.views.size(); ++v) {
    const std::vector<std::string> files = mask_files(scene, v);
    with_masks += !files.empty();
    const auto lost = std::ranges::find_if(files, [](const std::string& file) { return !is_regular_file(file); });
    are_parts &= std::ranges::count_if(files, is_regular_file) < 2;
    if (lost == files.end() || files.size() < 2) continue;
    if (count++ == 0) first = *lost;
  }
  if (count == 0) return {};
  if (count == with_masks)
    throw Error(
        ErrorCode::kInconsistent, "every view lacks the mask of an object (first: " + first + "), expected all",
        (are_parts ? "if these folders hold parts of the capture, not objects: move all masks into one folder; " : "") +
            std::string("if the object is not visible there: --missing-mask empty"));
  return std::to_string(count) + " views lack the mask of an object (first: " + first +
         "), their other masks are not used (if the object is not visible there: --missing-mask empty)";
}

std::string usual_masks(const std::string& base, const std::string& photos, UnfitMasks& unfit) {
  if (std::string folder = folder_called(base, "masks"); !folder.empty()) return folder;
  std::error_code ignored;
  const fs::path named = fs::path(base) / "masks";
  if (fs::exists(fs::symlink_status(named, ignored))) {
    unfit = {named.generic_string() + ": a " + (fs::exists(named, ignored) ? "file" : "link that leads nowhere") +
                 ", expected a folder of masks",
             "put the masks there, or name their folder: --masks DIR"};
    return {};
  }
  const auto full = [&](const std::string& path) { return fs::absolute(path, ignored).lexically_normal(); };
  const bool is_elsewhere = full(photos).lexically_relative(full(base)).string().starts_with("..");
  return is_elsewhere ? folder_called(fs::path(photos).parent_path().generic_string(), "masks") : "";
}

bool is_called_like_masks(const std::string& lower_name) {
  return lower_name.find("mask") != std::string::npos || lower_name.starts_with("segment") || lower_name == "seg" ||
         lower_name == "sam" || lower_name.starts_with("silhouette") || lower_name.starts_with("matte");
}

MaskFolders mask_folders_below(const std::string& base, const std::string& photos,
                               const std::vector<SceneView>& views) {
  FolderSearch search{base, photos, views};
  search.run("", kMaxDepth);
  return search.found;
}

std::vector<std::string> annotation_files(const std::string& given, const std::string& base,
                                          const std::vector<std::string>& folders) {
  if (is_regular_file(given)) return {given};
  std::vector<std::string> searched = folders, files;
  if (!given.empty()) searched = {given};
  if (given.empty()) searched.push_back((fs::path(base) / "annotations").generic_string());
  for (const std::string& folder : searched)
    if (!folder.empty())
      for (const std::string& path : files_below(folder))
        if (is_annotations(path)) files.push_back(path);
  std::error_code ignored;
  if (!given.empty()) return files;
  for (const fs::directory_entry& entry : fs::directory_iterator(base, ignored)) {
    const std::string name = lower_case(entry.path().filename().string());
    const bool suggests =
        name.find("coco") != name.npos || name.find("annotation") != name.npos || name.starts_with("instances");
    if (suggests && is_annotations(name) && is_regular_file(entry.path().generic_string()))
      files.push_back(entry.path().generic_string());
  }
  std::ranges::sort(files);
  files.erase(std::unique(files.begin(), files.end()), files.end());
  return files;
}

UnfitMasks unfit_masks(const std::string& folder, const std::vector<SceneView>& views) {
  std::vector<std::string> images, arrays, others;
  for (const std::string& path : is_regular_file(folder) ? std::vector{folder} : files_below(folder))
    (has_image_extension(path) ? images : is_array(path) ? arrays : others).push_back(path);
  const std::vector<std::string>& files = !images.empty() ? images : !arrays.empty() ? arrays : others;
  if (const std::vector<std::string> lost = lost_links(folder); files.empty() && !lost.empty())
    return {
        folder + ": " + std::to_string(lost.size()) + " links lead to no file (first: " + lost[0] + "), expected masks",
        "fetch the files, such as with git annex get or dvc pull"};
  if (files.empty() || views.empty()) return {};
  const std::string kind = !images.empty() ? " images" : !arrays.empty() ? " arrays" : " files";
  UnfitMasks unfit{folder + ": " + std::to_string(files.size()) + kind + " fit no view (first: " + files[0] +
                       "; the first view is " + views[0].camera.name + "), expected masks named after the photos",
                   "masks are images (PNG), or JSON of labelme or COCO with the names of the photos"};
  const bool is_one = images.size() == 1 && views.size() > 1 && !has_folder_per_photo(folder, views);
  if (is_one && !can_have_pages(images[0]))
    unfit.remedy = remedy_of_one(images[0], views[0]);
  else if (is_one)
    unfit.remedy = remedy_of_stack("convert " + shell_word(images[0]) + " masks-png/%04d.png");
  else if (!images.empty())
    unfit.remedy = remedy_of_images(folder, images, views);
  else if (!arrays.empty())
    unfit.remedy = remedy_of_arrays(folder, arrays, views);
  else if (files.size() > 1 && ending_of(files[0]) == ".gif")
    unfit.remedy = "convert them: mogrify -format png " + shell_word(folder) + "/*.gif";
  else if (is_film(files[0]))
    unfit.remedy = remedy_of_stack("ffmpeg -i " + shell_word(files[0]) + " masks-png/%04d.png");
  const auto archive =
      std::ranges::find_if(others, [](const std::string& path) { return !unpack_command(path, "").empty(); });
  if (images.empty() && arrays.empty() && archive != others.end())
    unfit.remedy =
        "an archive is not read, unpack it: " +
        unpack_command(*archive,
                       is_regular_file(folder) ? (fs::path(folder).parent_path() / "masks").string() : folder);
  return unfit;
}

std::string file_of_all_masks(const std::string& base) {
  std::error_code ignored;
  std::vector<std::string> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(base, ignored)) {
    const std::string path = entry.path().generic_string();
    const std::string stem = lower_case(entry.path().stem().string());
    const bool is_named = stem.find("mask") != std::string::npos;
    const bool is_image = has_image_extension(path) && (stem == "mask" || stem == "masks");
    const bool is_of_cvat = stem.starts_with("annotation") && ending_of(path) == ".xml";
    const bool is_packed = is_array(path) || is_film(path) || !unpack_command(path, "").empty();
    if (((is_named && (is_image || is_packed || ending_of(path).starts_with(".tif"))) || is_of_cvat) &&
        is_regular_file(path))
      files.push_back(path);
  }
  const std::string labels = folder_called(base, "labels");
  for (const fs::directory_entry& entry : fs::directory_iterator(labels, ignored))
    if (ending_of(entry.path().string()) == ".txt" && files.empty()) files.push_back(labels);
  std::ranges::sort(files);
  return files.empty() ? "" : files[0];
}

}  // namespace ngs::io
