#include <algorithm>
#include <filesystem>

#include "metrics_json.h"
#include "ngs/backend/for_each.h"
#include "ngs/core/error.h"
#include "ngs/core/formatted.h"
#include "ngs/io/files/mapped_file.h"
#include "ngs/io/ply/gaussian_ply.h"
#include "shared/text/layout.h"

namespace ngs::cli {
namespace {

struct IdMaps {
  std::vector<std::uint32_t> predicted, truth;  // [H·W] of the truth's size
  std::vector<std::uint8_t> is_void;            // [H·W]; empty: none
  int width_px = 0;
};

IdMaps read_id_maps(const EvalOptions& options, const FilePair& pair) {
  const io::RawMask predicted = read_mask(pair.predicted, true), truth = read_mask(pair.truth, true);
  IdMaps maps{resized_nearest(label_ids(predicted.samples()).data(), predicted.width_px, predicted.height_px,
                              truth.width_px, truth.height_px),
              label_ids(truth.samples()),
              {},
              truth.width_px};
  if (options.void_id < 0) return maps;
  for (std::uint32_t& id : maps.truth) {
    maps.is_void.push_back(id == std::uint32_t(options.void_id));
    if (maps.is_void.back()) id = 0;
  }
  for (std::size_t i = 0; i < maps.predicted.size(); ++i)
    if (maps.is_void[i] || maps.predicted[i] == std::uint32_t(options.void_id)) maps.predicted[i] = 0;
  return maps;
}

SceneInstances score_id_maps(Run& run, const EvalOptions& options, const std::vector<FilePair>& pairs) {
  auto scope = run.monitor().scope("score id maps");
  scope.items(std::int64_t(pairs.size()));
  std::vector<InstanceCounts> counts(pairs.size());
  const auto for_each_pair = [&](auto&& work) {
    for_each_task(run.exec(), std::int64_t(pairs.size()),
                  [&](std::int64_t i) { work(std::size_t(i), read_id_maps(options, pairs[std::size_t(i)])); });
  };
  for_each_pair([&](std::size_t i, const IdMaps& maps) { counts[i].add(maps.predicted, maps.truth, maps.is_void); });
  for (std::size_t i = 1; i < counts.size(); ++i) counts[0].add(counts[i]);
  SceneInstances scene{score_instances(counts[0]), {}};
  std::vector<std::map<std::uint32_t, double>> in_view(pairs.size());
  for_each_pair([&](std::size_t i, const IdMaps& maps) {
    for (const TrueInstance& instance : scene.scores.truth)
      if (instance.matched())
        if (const double biou = instance_biou(maps.predicted, maps.truth, maps.width_px, instance); biou >= 0)
          in_view[i][instance.id] = biou;
  });
  std::map<std::uint32_t, int> views;
  for (const auto& found : in_view)
    for (const auto& [id, biou] : found) {
      scene.biou[id] += biou;
      ++views[id];
    }
  for (auto& [id, biou] : scene.biou) biou /= views[id];
  return scene;
}

Json json_of(const SceneInstances& scene) {
  const InstanceScores& s = scene.scores;
  Json json = {{"ngs_metrics", kMetricsVersion},
               {"kind", "instances"},
               {"mean", mean_scores(scene)},
               {"counts",
                {{"true", s.truth.size()},
                 {"predicted", s.predicted.size()},
                 {"matched", s.matched},
                 {"split", s.split},
                 {"merged", s.merged},
                 {"missed", s.missed},
                 {"invented", s.invented}}},
               {"objects", Json::array()},
               {"predictions", Json::array()}};
  for (const TrueInstance& t : s.truth) {
    json["objects"].push_back({{"id", t.id},
                               {"pixels", t.pixels},
                               {"predicted_id", t.best},
                               {"iou", t.iou},
                               {"matched", t.matched()},
                               {"split", t.split},
                               {"missed", t.missed}});
    if (const auto biou = scene.biou.find(t.id); biou != scene.biou.end())
      json["objects"].back()["biou"] = biou->second;
  }
  for (const PredictedInstance& p : s.predicted)
    json["predictions"].push_back(
        {{"id", p.id}, {"pixels", p.pixels}, {"true_id", p.match}, {"merged_ids", p.merged}, {"invented", p.invented}});
  return json;
}

std::string table_of(const SceneInstances& scene) {
  const InstanceScores& s = scene.scores;
  std::string head, row;
  for (const auto& [name, value] : mean_scores(scene)) {
    head += "  " + std::string(8 - name.size(), ' ') + name;
    row += formatted("  %8.4f", value);
  }
  std::string table = head + "\n" + row + "\n";
  table += formatted("%.0f true objects: ", double(s.truth.size())) + formatted("%.0f matched, ", double(s.matched)) +
           formatted("%.0f split, ", double(s.split)) + formatted("%.0f missed; ", double(s.missed)) +
           formatted("%.0f predictions: ", double(s.predicted.size())) + formatted("%.0f merged, ", double(s.merged)) +
           formatted("%.0f invented\n", double(s.invented));
  std::vector<const TrueInstance*> worst;
  for (const TrueInstance& t : s.truth) worst.push_back(&t);
  std::ranges::stable_sort(worst, {}, [](const TrueInstance* t) { return t->iou; });
  table += "worst objects: ";
  for (std::size_t i = 0; i < std::min<std::size_t>(5, worst.size()); ++i)
    table += (i > 0 ? ", " : "") + std::to_string(worst[i]->id) + formatted(" (IoU %.2f)", worst[i]->iou);
  return table + "\n";
}

/// [N] number of the object, from 1; 0: none.
std::vector<std::uint32_t> ids_of_model(const std::string& path) {
  const io::GaussianPly ply = io::read_gaussian_ply(path, {io::HigherBands::kCheckOnly});
  std::vector<const LabelColumn*> labels;
  for (const io::NamedLabels& object : ply.objects) labels.push_back(&object.columns.label);
  if (labels.empty()) labels.push_back(&ply.labels.label);
  std::vector<std::uint32_t> ids(ply.cloud.size());
  std::vector<float> best(ids.size(), 0.5f);
  for (std::size_t k = 0; k < labels.size(); ++k) {
    if (labels[k]->size() != ids.size())
      throw Error(ErrorCode::kBadInput, path + ": no column ngs_label, expected the labelled PLY of ngs-joint");
    for (std::size_t i = 0; i < ids.size(); ++i)
      if (const float label = (*labels[k])[i]; label > best[i]) {
        best[i] = label;
        ids[i] = std::uint32_t(k + 1);
      }
  }
  return ids;
}

std::vector<std::uint32_t> bare_ids(const std::string& path, std::size_t gaussians) {
  const io::MappedFile file(path);
  const auto bytes = file.bytes();
  if (bytes.size() != gaussians && bytes.size() != 2 * gaussians)
    throw Error(ErrorCode::kInconsistent, path + ": " + std::to_string(bytes.size()) +
                                              " bytes, expected one or two for each of " + std::to_string(gaussians) +
                                              " Gaussians");
  std::vector<std::uint32_t> ids(gaussians);
  const std::size_t width = gaussians > 0 ? bytes.size() / gaussians : 1;
  for (std::size_t i = 0; i < bytes.size(); ++i) ids[i / width] |= std::uint32_t(bytes[i]) << (8 * (i % width));
  return ids;
}

InstanceCounts count_gaussians(const std::string& predicted, const std::string& truth) {
  const std::vector<std::uint32_t> found = ids_of_model(predicted);
  const std::vector<std::uint32_t> right = is_model(truth) ? ids_of_model(truth) : bare_ids(truth, found.size());
  if (right.size() != found.size())
    throw Error(ErrorCode::kInconsistent, predicted + ": " + std::to_string(found.size()) +
                                              " Gaussians, expected those of " + truth + ", " +
                                              std::to_string(right.size()));
  InstanceCounts counts;
  counts.add(found, right);
  return counts;
}

}  // namespace

bool is_model(const std::string& path) { return std::filesystem::path(path).extension() == ".ply"; }

void check_instances_options(Run& run, EvalOptions& options, const EvalFileOptions& files) {
  if (!files.instances) return;
  if (files.image_metrics || files.opacity || files.halves || !options.object_id.empty())
    throw Error(ErrorCode::kUsage,
                "--instances with --image-metrics, --opacity, --halves or --object-id, expected it without them");
  run.warn_unused({"--threshold", "--alone"}, "with --instances");
  options.label_map = true;
}

std::map<std::string, double> mean_scores(const SceneInstances& scene) {
  const InstanceScores& s = scene.scores;
  std::map<std::string, double> mean = {{"pq", s.pq}, {"sq", s.sq},     {"rq", s.rq},
                                        {"ap", s.ap}, {"ap50", s.ap50}, {"ap25", s.ap25}};
  if (!scene.of_views) return mean;
  mean["biou"] = 0;
  for (const auto& [id, value] : scene.biou) mean["biou"] += value / double(scene.biou.size());
  return mean;
}

Outcome instances_outcome(Run& run, const EvalOptions& options, const Pairing& pairing) {
  const SceneInstances scene = score_id_maps(run, options, pairing.pairs);
  return {json_of(scene), mean_scores(scene), table_of(scene)};
}

Outcome gaussians_outcome(const std::string& predicted, const std::string& truth) {
  const SceneInstances scene{score_instances(count_gaussians(predicted, truth)), {}, false};
  return {json_of(scene), mean_scores(scene), table_of(scene)};
}

}  // namespace ngs::cli
