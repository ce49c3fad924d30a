#pragma once
// Names of views: image names, output file names, and look-up of a view by name. Also names of objects' folders.
#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ngs/scene/scene.h"

namespace ngs {

/// True for the supported formats: PNG, JPEG, EXR, TIFF, WebP, BMP, PPM and PGM, case-insensitive.
bool has_image_extension(std::string_view name);
/// True for unsupported photo formats of phones and cameras (HEIC, AVIF, DNG ...). Camera files may name such photos
/// while the images on disk are copies in another format.
bool has_unread_extension(std::string_view name);
/// The name without a supported or unsupported photo extension: "a.b.png" -> "a.b", "frame.0001" -> itself. Folders
/// remain.
std::string image_stem(std::string_view name);
/// The name without its folders.
std::string bare_name(std::string_view name);

/// True for a single folder name: not empty, no slashes, not "." or "..".
bool is_folder_name(std::string_view name);

/// [views] unique names, without extension, for the output files of each view. If all photo stems are unique: the stem.
/// Else, for all views, the path without extension ("cam0/0001", as in camera rigs). If these are not unique either
/// (a.png, a.jpg): the whole name.
std::vector<std::string> output_names(const std::vector<SceneView>& views);

/// Look-up of views by name.
class ViewNames {
 public:
  explicit ViewNames(const std::vector<SceneView>& views);

  /// Indices of the views that match `name`: by exact name, else by path with any extension, else by output name, else
  /// by path or output name in another case or Unicode form (core/folded_name.h). Empty or several if the name is
  /// unknown or ambiguous.
  std::vector<std::size_t> find(std::string_view name) const;

 private:
  using Indices = std::map<std::string, std::vector<std::size_t>, std::less<>>;
  Indices by_name_, by_path_, by_output_name_, by_folded_path_, by_folded_name_;
};

/// "every:N:K": selects indices i with i % n == k.
struct EveryRule {
  std::size_t n = 1, k = 0;
  bool selects(std::size_t index) const { return index % n == k; }
};
/// Empty unless the text is "every:N:K" with K < N.
std::optional<EveryRule> parse_every(std::string_view rule);
/// Indices of sorted names that the rule "every:N:K" or "all" selects: index % N == K. Throws kUsage for other rules.
std::vector<std::size_t> select_every(std::string_view rule, std::size_t count);

}  // namespace ngs
