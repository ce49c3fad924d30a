#include "ngs/scene/view_names.h"

#include <algorithm>
#include <array>
#include <set>

#include "ngs/core/error.h"
#include "ngs/core/folded_name.h"
#include "ngs/core/parse_number.h"

namespace ngs {
namespace {

using namespace std::string_view_literals;

std::size_t base_of(std::string_view name) {
  const std::size_t slash = name.rfind('/');
  return slash == name.npos ? 0 : slash + 1;
}

/// Position of the extension's dot; the end of the name if there is no extension.
std::size_t extension_of(std::string_view name) {
  const std::size_t dot = name.rfind('.');
  return dot == name.npos || dot <= base_of(name) ? name.size() : dot;
}

std::string lower_extension(std::string_view name) { return lower_case(name.substr(extension_of(name))); }

template <class Rule>
std::vector<std::string> names_by(const std::vector<SceneView>& views, const Rule& rule) {
  std::vector<std::string> names;
  for (const SceneView& view : views) names.push_back(rule(view.camera.name));
  return names;
}

std::vector<std::string> folded(std::vector<std::string> names) {
  for (std::string& name : names) name = folded_name(name);
  return names;
}

bool is_each_once(const std::vector<std::string>& names) {
  return std::set<std::string>(names.begin(), names.end()).size() == names.size();
}

auto indices_of(const std::vector<std::string>& names) {
  std::map<std::string, std::vector<std::size_t>, std::less<>> indices;
  for (std::size_t i = 0; i < names.size(); ++i) indices[names[i]].push_back(i);
  return indices;
}

}  // namespace

bool has_image_extension(std::string_view name) {
  constexpr std::array kKnown{".png"sv,  ".jpg"sv,  ".jpeg"sv, ".exr"sv, ".tif"sv,
                              ".tiff"sv, ".webp"sv, ".bmp"sv,  ".ppm"sv, ".pgm"sv};
  return std::find(kKnown.begin(), kKnown.end(), lower_extension(name)) != kKnown.end();
}

bool has_unread_extension(std::string_view name) {
  constexpr std::array kUnread{".heic"sv, ".heif"sv, ".avif"sv, ".jxl"sv, ".gif"sv, ".dng"sv, ".cr2"sv,
                               ".cr3"sv,  ".nef"sv,  ".arw"sv,  ".orf"sv, ".raf"sv, ".rw2"sv};
  return std::find(kUnread.begin(), kUnread.end(), lower_extension(name)) != kUnread.end();
}

std::string image_stem(std::string_view name) {
  const bool has_extension = has_image_extension(name) || has_unread_extension(name);
  return std::string(has_extension ? name.substr(0, extension_of(name)) : name);
}

std::string bare_name(std::string_view name) { return std::string(name.substr(base_of(name))); }

bool is_folder_name(std::string_view name) {
  return !name.empty() && name != "." && name != ".." && name.find_first_of("/\\\0"sv) == name.npos;
}

std::vector<std::string> output_names(const std::vector<SceneView>& views) {
  std::vector<std::string> names = names_by(views, [](auto& name) { return image_stem(bare_name(name)); });
  // The scheme is the same for all views: files at two folder depths would look like two kinds of files.
  if (!is_each_once(names)) names = names_by(views, image_stem);
  if (!is_each_once(names)) names = names_by(views, [](auto& name) { return name; });
  return names;
}

ViewNames::ViewNames(const std::vector<SceneView>& views)
    : by_name_(indices_of(names_by(views, [](auto& name) { return name; }))),
      by_path_(indices_of(names_by(views, image_stem))),
      by_output_name_(indices_of(output_names(views))),
      by_folded_path_(indices_of(folded(names_by(views, image_stem)))),
      by_folded_name_(indices_of(folded(output_names(views)))) {}

std::vector<std::size_t> ViewNames::find(std::string_view name) const {
  if (const auto own = by_name_.find(name); own != by_name_.end()) return own->second;
  const std::string stem = image_stem(name);
  for (const Indices* names : {&by_path_, &by_output_name_})
    if (const auto found = names->find(stem); found != names->end()) return found->second;
  for (const Indices* names : {&by_folded_path_, &by_folded_name_})
    if (const auto found = names->find(folded_name(stem)); found != names->end()) return found->second;
  return {};
}

std::optional<EveryRule> parse_every(std::string_view rule) {
  constexpr std::string_view kPrefix = "every:";
  if (!rule.starts_with(kPrefix)) return std::nullopt;
  const std::string_view numbers = rule.substr(kPrefix.size());
  const std::size_t colon = numbers.find(':');
  EveryRule every;
  if (colon == numbers.npos || !parse_number(numbers.substr(0, colon), every.n) ||
      !parse_number(numbers.substr(colon + 1), every.k) || every.k >= every.n)
    return std::nullopt;
  return every;
}

std::vector<std::size_t> select_every(std::string_view rule, std::size_t count) {
  const std::optional<EveryRule> every = rule == "all" ? EveryRule{} : parse_every(rule);
  if (!every)
    throw Error(ErrorCode::kUsage,
                "views = '" + std::string(rule) + "', expected all, every:N:K with K < N, or a file of names");
  std::vector<std::size_t> selected;
  for (std::size_t i = 0; i < count; ++i)
    if (every->selects(i)) selected.push_back(i);
  return selected;
}

}  // namespace ngs
