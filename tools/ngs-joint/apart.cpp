#include "apart.h"

#include <algorithm>
#include <set>

#include "ngs/core/version.h"
#include "ngs/io/files/content_hash.h"
#include "ngs/methods/apart.h"
#include "ngs/stages/boundary/variance_stage.h"
#include "optimise.h"
#include "shared/changed_options.h"
#include "shared/shard.h"

namespace ngs::joint {
namespace {

std::vector<io::NamedLabels> objects_of(const io::GaussianPly& ply) {
  std::vector<io::NamedLabels> objects = ply.objects;
  if (objects.empty()) objects = {{ply.object, ply.labels}};
  for (const io::NamedLabels& object : objects)
    for (const auto column : {&LabelColumns::label, &LabelColumns::prob, &LabelColumns::variance,
                              &LabelColumns::views, &LabelColumns::boundary})
      if ((object.columns.*column).size() != std::size_t(ply.cloud.size()))
        throw Error(ErrorCode::kBadInput, ply.file.name() + ": object '" + object.object +
                                              "' has not all of its ngs_ columns, expected five");
  return objects;
}

/// A part with its positions relative to the model's origin.
io::GaussianPly read_part(const std::string& path, const std::string& model_hash, const GaussianCloud& model) {
  io::GaussianPly part = io::read_gaussian_ply(path, model.origin);
  if (part.apart_of.empty() || part.source_row.size() != std::size_t(part.cloud.size()))
    throw Error(ErrorCode::kBadInput, path + ": no ngs-apart comment or no column ngs_source, expected both",
                "make the part with ngs-joint --apart i/N");
  if (part.apart_of != model_hash)
    throw Error(ErrorCode::kInconsistent, path + ": made from another model (" + part.apart_of + ", this is " +
                                              model_hash + ")",
                "give the boundary PLY that all parts were made from");
  return part;
}

/// kInconsistent where the parts were not made alike.
void check_made_alike(const std::vector<io::GaussianPly>& parts) {
  for (const io::GaussianPly& part : parts)
    if (part.made_with != parts[0].made_with)
      throw Error(ErrorCode::kInconsistent,
                  part.file.name() + ": made with " + part.made_with + ", but " + parts[0].file.name() + " with " +
                      parts[0].made_with,
                  "make all parts from one scene.json, with the same options and the same ngs");
}

ModelPart model_part(const io::GaussianPly& ply, const std::vector<io::NamedLabels>& model_objects) {
  ModelPart part{ply.file.name(), &ply.cloud, &ply.source_row, {}, {}};
  for (const io::NamedLabels& object : objects_of(ply)) {
    const auto known = std::find_if(model_objects.begin(), model_objects.end(),
                                    [&](const io::NamedLabels& o) { return o.object == object.object; });
    if (known == model_objects.end())
      throw Error(ErrorCode::kInconsistent, part.name + ": object '" + object.object + "' is not in the model");
    part.objects.push_back(std::size_t(known - model_objects.begin()));
    part.labels.push_back(object.columns);
  }
  return part;
}

int merge(cli::Run& run, const std::string& model_path, const std::vector<std::string>& paths,
          const std::string& out) {
  const io::GaussianPly model = io::read_gaussian_ply(model_path);
  const std::string hash = io::content_hash(model_path).xxh3;
  std::vector<io::NamedLabels> objects = objects_of(model);
  std::vector<LabelColumns> labels;
  for (const io::NamedLabels& object : objects) labels.push_back(object.columns);
  std::vector<io::GaussianPly> read;
  for (const std::string& path : paths) read.push_back(read_part(path, hash, model.cloud));
  check_made_alike(read);
  std::vector<ModelPart> parts;
  for (const io::GaussianPly& part : read) parts.push_back(model_part(part, objects));
  std::vector<std::uint8_t> in_part(objects.size(), 0);
  for (const ModelPart& part : parts)
    for (const std::size_t object : part.objects) in_part[object] = 1;
  for (std::size_t k = 0; k < objects.size(); ++k)
    if (!in_part[k])
      run.monitor().warn("object '" + objects[k].object + "' is in no part, its labels stay as they are in the model");
  const Solution joined = join_parts(model.cloud, labels, parts);
  for (std::size_t k = 0; k < objects.size(); ++k) objects[k].columns = joined.labels[k];
  for (const auto& [name, value] : joined.figures) run.result()[name] = std::int64_t(value);
  run.result()["parts"] = parts.size(), run.result()["objects"] = objects.size();
  if (run.dry_run()) return cli::kDone;
  io::LabelledWrite write;
  write.edited = &joined.cloud, write.source_row = joined.source_row;
  io::write_labelled_ply(out, model, objects, write);
  return cli::kDone;
}

}  // namespace

ApartRun apart_run(const io::GaussianPly& ply, const Scene& scene, const std::string& shard) {
  const std::vector<LabelColumns> labels = labels_of(ply, scene);
  const std::vector<std::vector<std::size_t>> groups = objects_that_meet(labels);
  ApartRun apart{scene, {}, Json::array()};
  for (const std::vector<std::size_t>& group : groups) {
    apart.groups.push_back(Json::array());
    for (const std::size_t k : group) apart.groups.back().push_back(scene.objects[k].name);
  }
  if (shard.empty()) return apart;
  const cli::Shard part = cli::parse_shard("--apart", shard);
  if (part.count > groups.size())
    throw Error(ErrorCode::kUsage, "--apart: '" + shard + "', expected at most " + std::to_string(groups.size()) +
                                       " parts: so many groups of objects do not meet",
                "--dry-run lists them");
  std::vector<std::size_t> chosen;
  for (std::size_t g = part.index; g < groups.size(); g += part.count)
    chosen.insert(chosen.end(), groups[g].begin(), groups[g].end());
  std::sort(chosen.begin(), chosen.end());
  std::vector<std::string> names;
  for (const std::size_t k : chosen) names.push_back(scene.objects[k].name);
  apart.held = held_rows(labels, chosen);
  apart.scene = with_objects(scene, names);
  return apart;
}

std::string part_made_with(const cli::Run& run, const Declared& declared, const Paths& paths) {
  const auto hash = [](const std::string& path) { return io::content_hash(path).xxh3; };
  std::string text = std::string("ngs ") + kVersion + ", scene " + hash(paths.scene) + ", --seed " + std::to_string(run.seed());
  if (!paths.effects_from.empty()) text += ", --effects-from " + hash(paths.effects_from);
  const std::set<std::string> own{"apart", "checkpoint", "checkpoint_every", "resume", "time_budget", "trace_every"};
  const auto add = [&](const auto& group) {
    for (const auto& [name, value] : cli::changed_options(group))
      if (!own.contains(name)) text += ", " + option_flag(name) + " " + value.dump(-1, ' ', true);
  };
  const Settings& s = declared.settings;
  const MethodOptions& m = declared.methods;
  add(s.run), add(s.joint), add(s.edge), add(s.sample), add(s.rbf), add(declared.raster);
  add(m.flash), add(m.sa3d), add(m.bce), add(m.cob), add(m.saga), add(m.released);
  return text;
}

int merge_parts(int argc, char** argv) {
  cli::Tool tool("ngs-joint merge", "Join the results of objects that were run apart into one labelled model.",
                 {"ngs-joint merge boundary.ply part0.ply part1.ply -o labelled.ply"});
  const cli::Input& model = tool.input("boundary", "the PLY that all parts were made from");
  const cli::Inputs& parts = tool.inputs("parts", "labelled PLYs of ngs-joint --apart, in any order");
  const cli::Output& out = tool.output("-o,--output", "labelled PLY with the objects of all parts");
  return tool.run(argc, argv,
                  [&](cli::Run& run) { return merge(run, model.path, parts.paths, out.path); });
}

}  // namespace ngs::joint
