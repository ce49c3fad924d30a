#pragma once
// The names of views: what is an image's name, what files are called after a view, and which view a name means; and of
// objects, which have folders of theirs.
#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ngs/scene/scene.h"

namespace ngs {

/// True for the formats that are read: PNG, JPEG, EXR, TIFF, WebP, BMP, PPM and PGM, in either case.
bool has_image_extension(std::string_view name);
/// True for endings of photos that nothing here reads: those of phones and of cameras' raw data (HEIC, AVIF, DNG ...).
/// Cameras name such files, the photos are copies in another format.
bool has_unread_extension(std::string_view name);
/// The name without an extension of either kind: "a.b.png" -> "a.b", "frame.0001" -> itself. Folders are kept.
std::string image_stem(std::string_view name);
/// The name without its folders.
std::string bare_name(std::string_view name);

/// True for the name of one folder: not empty, without slashes, and neither "." nor "..".
bool is_folder_name(std::string_view name);

/// [views] what the files of each view are called, without extension and each once: the stem of its photo where no
/// two views share one, else, for all views, the path without extension ("cam0/0001"), as the photos of rigs have
/// it, and where even these are shared (a.png, a.jpg) the whole name.
std::vector<std::string> output_names(const std::vector<SceneView>& views);

/// Which views a name means, for any number of names.
class ViewNames {
 public:
  explicit ViewNames(const std::vector<SceneView>& views);

  /// Indices of the views that `name` means: the view of this very name, else those with this path, whatever the
  /// extension, else the one whose output name it is; none or several where it is not the name of one view.
  std::vector<std::size_t> find(std::string_view name) const;

 private:
  using Indices = std::map<std::string, std::vector<std::size_t>, std::less<>>;
  Indices by_name_, by_path_, by_output_name_;
};

/// "every:N:K": each index i with i % n == k.
struct EveryRule {
  std::size_t n = 1, k = 0;
  bool selects(std::size_t index) const { return index % n == k; }
};
/// Empty unless the text is "every:N:K" with K < N.
std::optional<EveryRule> parse_every(std::string_view rule);

}  // namespace ngs
