#include "opacity_scores.h"

#include <algorithm>

#include "metrics_json.h"
#include "ngs/backend/for_each.h"
#include "ngs/core/formatted.h"
#include "ngs/io/image/image_file.h"
#include "ngs/io/image/masks.h"
#include "shared/text/layout.h"

namespace ngs::cli {
namespace {

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
  for (std::size_t i = 0; i < labels.size(); ++i)
    silhouette[i] = labels[i] == wanted, others[i] = labels[i] != wanted && labels[i] != 0;
  return {pair.view, opacity_errors(opacity_of(predicted), {silhouette.data(), w, h}, {others.data(), w, h})};
}

Json values_json(const std::map<std::string, double>& values) {
  Json json = Json::object();
  for (const auto& [name, value] : values) json[name] = value;
  return json;
}

std::map<std::string, double> values_of(const OpacityErrors& errors) {
  std::map<std::string, double> values;
  for (std::size_t b = 0; b < kHaloBands_px.size(); ++b) {
    const std::string band = std::to_string(kHaloBands_px[b]) + "px";
    values["halo_" + band] = errors.halo_px[b], values["holes_" + band] = errors.holes_px[b];
  }
  return values;
}

}  // namespace

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
  Json json = {{"ngs_metrics", kMetricsVersion},
               {"kind", "opacities"},
               {"mean", values_json(mean_scores(scores))},
               {"views", Json::array()}};
  for (const OpacityScore& score : scores) {
    Json view = {{"view", score.view}, {"contour_px", score.errors.contour_px}};
    view.update(values_json(values_of(score.errors)));
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
