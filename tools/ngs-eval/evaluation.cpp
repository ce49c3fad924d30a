#include "evaluation.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include "ngs/backend/for_each.h"
#include "ngs/core/error.h"
#include "ngs/core/formatted.h"
#include "ngs/core/parse_number.h"
#include "ngs/io/files/match_names.h"
#include "ngs/io/files/text_lines.h"
#include "ngs/io/image/exr.h"
#include "ngs/io/image/masks.h"
#include "ngs/scene/view_names.h"
#include "shared/text/layout.h"

namespace ngs::cli {
namespace {

/// The names without their leading folders beyond `most`, without duplicates.
std::vector<std::string> with_folders(const std::vector<std::string>& names, int most) {
  std::set<std::string> files;
  for (std::string name : names) {
    for (auto folders = std::count(name.begin(), name.end(), '/'); folders > most; --folders)
      name.erase(0, name.find('/') + 1);
    files.insert(name);
  }
  return {files.begin(), files.end()};
}

std::uint32_t id_of(const std::string& object, const ObjectIds& ids) {
  for (const auto& [id, name] : ids)
    if (name == object) return id;
  std::uint32_t id = 0;
  if (parse_number(object, id) && id > 0) return id;
  throw Error(ErrorCode::kUsage, "the id of object '" + object + "' in the true label maps is unknown",
              "give it: --object-id " + object + "=ID");
}

std::vector<std::string> select_truth(const ImageList& truth, const EvalFileOptions& options, Pairing& pairing) {
  const std::string& rule = options.views;
  const bool of_scene = !options.scene_views.empty();
  std::vector<std::string> selected;
  if (!of_scene && (rule == "all" || rule.starts_with("every:"))) {
    for (std::size_t i : select_every(rule, truth.names.size())) selected.push_back(truth.names[i]);
    return selected;
  }
  const std::vector<std::string> listed =
      with_folders(of_scene ? options.scene_views : io::read_name_list(rule), depth(truth));
  const io::NameMatch match = io::match_names(listed, truth.names);
  for (const io::NamePair& pair : match.pairs) selected.push_back(truth.names[pair.truth]);
  for (std::size_t i : match.unmatched_predicted) pairing.listed_only.push_back(listed[i]);
  return selected;
}

/// Predictions outside the selection are not reported, only those that match no true mask at all.
void note_unmatched(const io::NameMatch& all, const ImageList& predicted, Pairing& pairing) {
  for (std::size_t i : all.unmatched_predicted) pairing.predicted_only.push_back(predicted.names[i]);
}

void name_parts(const std::string& name, Layout layout, FilePair& pair) {
  const std::string stem = image_stem(name);
  const std::size_t slash = layout == Layout::kViewObject ? stem.rfind('/') : stem.find('/');
  if (slash == std::string::npos || layout == Layout::kView) {
    pair.view = stem;
    return;
  }
  const std::string before = stem.substr(0, slash), behind = stem.substr(slash + 1);
  pair.view = layout == Layout::kViewObject ? before : behind;
  pair.object = layout == Layout::kViewObject ? behind : before;
}

io::RawMask read_exr_ids(const std::string& path) {
  const ImageF ids = io::read_id_exr(path);
  io::RawMask raw{.width_px = ids.width_px, .height_px = ids.height_px, .channels = 1, .bits = 16, .data = {}};
  for (const float id : ids.data) raw.data.push_back(std::uint16_t(id));
  return raw;
}

io::RawMask read_exr_mask(const std::string& path) {
  const io::ExrImage exr = io::read_exr(path);
  const auto mask = exr.channels.find("ngs.mask");
  if (mask == exr.channels.end())
    throw Error(ErrorCode::kBadInput, path + ": no channel 'ngs.mask', expected the EXR of ngs-render --layers mask");
  io::RawMask raw{.width_px = exr.width_px, .height_px = exr.height_px, .channels = 1, .bits = 16, .data = {}};
  raw.data.reserve(mask->second.size());
  for (float value : mask->second) {
    if (!std::isfinite(value))
      throw Error(ErrorCode::kBadInput, path + ": mask value " + std::to_string(value) + ", expected [0, 1]");
    raw.data.push_back(std::uint16_t(std::lround(65535.0 * std::clamp(double(value), 0.0, 1.0))));
  }
  return raw;
}

Pairing matched_files(const ImageList& predicted, const ImageList& truth, const EvalFileOptions& options) {
  Pairing pairing;
  const std::vector<std::string> selected = select_truth(truth, options, pairing);
  io::NameMatch match = io::match_names(predicted.names, truth.names);
  note_unmatched(match, predicted, pairing);
  // One file each: they form a pair, whatever their names.
  if (match.pairs.empty() && predicted.names.size() == 1 && truth.names.size() == 1) {
    match = {.pairs = {{0, 0, "given"}}, .unmatched_predicted = {}, .unmatched_truth = {}};
    pairing.predicted_only.clear();
  }
  const auto is_selected = [&](std::size_t i) {
    return std::find(selected.begin(), selected.end(), truth.names[i]) != selected.end();
  };
  std::map<std::string, int> rules;
  for (const io::NamePair& found : match.pairs) {
    if (!is_selected(found.truth)) continue;
    FilePair pair{{}, {}, predicted.path(found.predicted), truth.path(found.truth)};
    name_parts(truth.names[found.truth], options.image_metrics ? Layout::kView : options.layout, pair);
    pairing.pairs.push_back(std::move(pair));
    ++rules[std::string(found.rule)];
  }
  for (std::size_t i : match.unmatched_truth)
    if (is_selected(i)) pairing.truth_only.push_back(truth.names[i]);
  pairing.matched_by.assign(rules.begin(), rules.end());
  return pairing;
}

void require_pairs(const Pairing& pairing, const ImageList& predicted, const ImageList& truth,
                   const EvalFileOptions& options) {
  if (!pairing.pairs.empty()) return;
  const std::string& wanted = pairing.truth_only.empty() ? truth.names.front() : pairing.truth_only.front();
  throw Error(ErrorCode::kInconsistent,
              predicted.folder + " and " + truth.folder + ": no file matches, found '" + predicted.names.front() +
                  "' and '" + wanted + "', expected the same stems or numbers",
              "name the predictions like the true masks, or check --views " + options.views);
}

namespace fs = std::filesystem;

constexpr int kMaxFolders = 3;  // object, camera of a rig, and one more; also stops cyclic links

bool is_hidden(const fs::path& path) { return path.filename().string().starts_with('.'); }

void add_images(const fs::path& folder, const std::string& prefix, std::vector<std::string>& names) {
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (!is_hidden(entry.path()) && entry.is_regular_file() && has_image_extension(name))
      names.push_back(prefix + name);
  }
}

void add_images_below(const fs::path& folder, const std::string& prefix, int depth, std::vector<std::string>& names) {
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (is_hidden(entry.path()) || !entry.is_directory()) continue;
    const std::string below = prefix + entry.path().filename().string() + "/";
    add_images(entry.path(), below, names);
    if (depth < kMaxFolders) add_images_below(entry.path(), below, depth + 1, names);
  }
}

std::string size_of(const io::RawMask& raw) { return to_string(io::ImageSize{raw.width_px, raw.height_px}); }

/// [H, W] in [0, 1].
std::vector<float> opacity_of(const io::RawMask& raw) {
  const DecisiveSamples decisive = decisive_samples(raw.samples());
  std::vector<float> opacity(decisive.value.size());
  for (std::size_t i = 0; i < opacity.size(); ++i) opacity[i] = float(decisive.value[i]) / decisive.full_scale;
  return opacity;
}

OpacityScore score_opacity(const EvalOptions& options, const ObjectIds& ids, const FilePair& pair) {
  if (io::is_exr(pair.predicted))
    throw Error(ErrorCode::kBadInput, pair.predicted + ": an EXR, expected the PNG of ngs-render --layers alpha");
  const io::RawMask predicted = io::read_mask_raw(pair.predicted, io::Palette::kMask);
  const io::RawMask truth =
      io::read_mask_raw(pair.truth, options.label_map ? io::Palette::kIndices : io::Palette::kMask);
  if (predicted.width_px != truth.width_px || predicted.height_px != truth.height_px)
    throw Error(
        ErrorCode::kInconsistent,
        pair.predicted + ": " + size_of(predicted) + ", expected the size of " + pair.truth + ", " + size_of(truth),
        "render at the size of the true masks: ngs-render --scale S");
  const int w = truth.width_px, h = truth.height_px;
  if (!options.label_map) {
    const std::vector<std::uint8_t> silhouette = binarised(truth.samples(), options.threshold);
    return {pair.view, opacity_errors(opacity_of(predicted), {silhouette.data(), w, h})};
  }
  const std::vector<std::uint32_t> labels = label_ids(truth.samples());
  const std::uint32_t wanted = ids.begin()->first;
  std::vector<std::uint8_t> silhouette(labels.size()), others(labels.size());
  for (std::size_t i = 0; i < labels.size(); ++i) {
    silhouette[i] = labels[i] == wanted;
    others[i] = labels[i] != wanted && labels[i] != 0;
  }
  return {pair.view, opacity_errors(opacity_of(predicted), {silhouette.data(), w, h}, {others.data(), w, h})};
}

std::map<std::string, double> values_of(const OpacityErrors& errors) {
  std::map<std::string, double> values;
  for (std::size_t b = 0; b < kHaloBands_px.size(); ++b) {
    const std::string band = std::to_string(kHaloBands_px[b]) + "px";
    values["halo_" + band] = errors.halo_px[b];
    values["holes_" + band] = errors.holes_px[b];
  }
  return values;
}

}  // namespace

io::RawMask read_mask(const std::string& path, bool is_label_map) {
  if (io::is_exr(path)) return is_label_map ? read_exr_ids(path) : read_exr_mask(path);
  return io::read_mask_raw(path, is_label_map ? io::Palette::kIndices : io::Palette::kMask);
}

int depth(const ImageList& list) {
  const std::string& name = list.names.front();
  return int(std::count(name.begin(), name.end(), '/'));
}

Pairing pair_files(const ImageList& predicted, const ImageList& truth, const EvalFileOptions& options) {
  Pairing pairing = matched_files(predicted, truth, options);
  if (pairing.pairs.empty() && depth(predicted) > depth(truth))
    throw Error(ErrorCode::kInconsistent,
                predicted.folder + ": its masks are in folders, " + predicted.names.front() + ", and " + truth.folder +
                    " has no folders, " + truth.names.front() + ", expected the same layout",
                "score one of several objects, " + predicted.folder + "/" +
                    predicted.names.front().substr(0, predicted.names.front().rfind('/')) +
                    ", or all objects against true label maps: --label-map --object-id NAME=ID");
  require_pairs(pairing, predicted, truth, options);
  return pairing;
}

Pairing pair_objects(const ImageList& predicted, const ImageList& truth, const EvalFileOptions& options,
                     const ObjectIds& ids) {
  std::map<std::string, ImageList> objects;
  for (const std::string& name : predicted.names) {
    const std::size_t slash = name.find('/');
    ImageList& list = objects[name.substr(0, slash)];
    list.folder = predicted.folder + "/" + name.substr(0, slash);
    list.names.push_back(name.substr(slash + 1));
  }
  Pairing all;
  EvalFileOptions of_one_object = options;
  of_one_object.layout = Layout::kView;
  std::map<std::string, int> rules;
  for (const auto& [object, list] : objects) {
    Pairing mine = matched_files(list, truth, of_one_object);
    for (FilePair& pair : mine.pairs) {
      pair.object = object;
      pair.truth_id = id_of(object, ids);
      all.pairs.push_back(std::move(pair));
    }
    for (const auto& [rule, count] : mine.matched_by) rules[rule] += count;
    for (const std::string& name : mine.predicted_only) all.predicted_only.push_back(object + "/" + name);
    for (const std::string& name : mine.truth_only) all.truth_only.push_back(name + " (" + object + ")");
    all.listed_only = mine.listed_only;
  }
  all.matched_by.assign(rules.begin(), rules.end());
  require_pairs(all, predicted, truth, options);
  return all;
}

std::vector<PairScore> score_masks(Run& run, const EvalOptions& options, const std::vector<FilePair>& pairs) {
  const ObjectIds ids = parse_object_ids(options.object_id);
  auto scope = run.monitor().scope("score masks");
  scope.items(std::int64_t(pairs.size()));
  std::vector<std::vector<PairScore>> found(pairs.size());
  for_each_task(run.exec(), std::int64_t(pairs.size()), [&](std::int64_t index) {
    const auto i = std::size_t(index);
    const io::RawMask predicted = read_mask(pairs[i].predicted, options.label_map && pairs[i].truth_id == 0),
                      truth = read_mask(pairs[i].truth, options.label_map);
    const EvalPair pair{pairs[i].view, pairs[i].object, predicted.samples(), truth.samples(), pairs[i].truth_id};
    found[i] = evaluate_pair(Exec{}, options, ids, pair);
  });
  std::vector<PairScore> scores;
  for (std::vector<PairScore>& of_pair : found) std::move(of_pair.begin(), of_pair.end(), std::back_inserter(scores));
  return scores;
}

std::vector<PhotoScore> score_photos(Run& run, const std::vector<FilePair>& pairs) {
  auto scope = run.monitor().scope("score photos");
  scope.items(std::int64_t(pairs.size()));
  std::vector<PhotoScore> scores(pairs.size());
  for_each_task(run.exec(), std::int64_t(pairs.size()), [&](std::int64_t index) {
    const auto i = std::size_t(index);
    const ImageF predicted = io::read_image_rgb(pairs[i].predicted), truth = io::read_image_rgb(pairs[i].truth);
    if (predicted.width_px != truth.width_px || predicted.height_px != truth.height_px)
      throw Error(ErrorCode::kInconsistent,
                  pairs[i].predicted + ": " + std::to_string(predicted.width_px) + "x" +
                      std::to_string(predicted.height_px) + ", expected the size of " + pairs[i].truth + ", " +
                      std::to_string(truth.width_px) + "x" + std::to_string(truth.height_px),
                  "render at the photo's size: ngs-render --scale S");
    scores[i] = {pairs[i].view, std::min(psnr_db(Exec{}, predicted, truth), kEqualPsnrDb),
                 ssim_index(Exec{}, predicted, truth)};
  });
  return scores;
}

ImageList list_images(const std::string& path) {
  if (!fs::is_directory(path)) {
    const fs::path file(path);
    return {file.has_parent_path() ? file.parent_path().generic_string() : ".", {file.filename().string()}};
  }
  ImageList list{path, {}};
  add_images(path, "", list.names);
  if (list.names.empty()) add_images_below(path, "", 1, list.names);
  std::sort(list.names.begin(), list.names.end());
  if (list.names.empty())
    throw Error(ErrorCode::kBadInput,
                path + ": no image found, expected PNG, JPEG, TIFF, BMP, WebP, PPM, PGM or EXR files");
  return list;
}

void require_one_object(const EvalOptions& options) {
  if (options.label_map && options.object_id.size() != 1)
    throw Error(ErrorCode::kUsage, "opacity with label_map, expected the id of one object",
                "give the object of these opacities with --object-id ID");
}

std::vector<OpacityScore> score_opacities(Run& run, const EvalOptions& options, const std::vector<FilePair>& pairs) {
  const ObjectIds ids = parse_object_ids(options.object_id);
  auto scope = run.monitor().scope("score opacities");
  scope.items(std::int64_t(pairs.size()));
  std::vector<OpacityScore> scores(pairs.size());
  for_each_task(run.exec(), std::int64_t(pairs.size()),
                [&](std::int64_t i) { scores[std::size_t(i)] = score_opacity(options, ids, pairs[std::size_t(i)]); });
  std::erase_if(scores, [](const OpacityScore& score) { return score.errors.contour_px == 0; });
  if (scores.empty())
    throw Error(ErrorCode::kNothingFound, "no true mask has a contour of the object",
                "check the true masks and --object-id");
  return scores;
}

Json opacity_metrics_json(const std::vector<OpacityScore>& scores) {
  Json json = {
      {"ngs_metrics", kMetricsVersion}, {"kind", "opacities"}, {"mean", mean_scores(scores)}, {"views", Json::array()}};
  for (const OpacityScore& score : scores) {
    Json view = {{"view", score.view}, {"contour_px", score.errors.contour_px}};
    view.update(Json(values_of(score.errors)));
    json["views"].push_back(std::move(view));
  }
  return json;
}

std::map<std::string, double> mean_scores(const std::vector<OpacityScore>& scores) {
  std::map<std::string, double> mean;
  for (const OpacityScore& score : scores)
    for (const auto& [name, value] : values_of(score.errors)) mean[name] += value / double(scores.size());
  return mean;
}

std::string opacity_table(const std::vector<OpacityScore>& scores) {
  std::string table =
      "px of full opacity per px of contour, farther from it than      1 px      2 px      3 px      5 px\n";
  const std::map<std::string, double> mean = mean_scores(scores);
  for (const char* kind : {"halo", "holes"}) {
    table += in_columns(kind, 58);
    for (const int band_px : kHaloBands_px)
      table += formatted("%10.3f", mean.at(std::string(kind) + "_" + std::to_string(band_px) + "px"));
    table += "\n";
  }
  return table;
}

}  // namespace ngs::cli
