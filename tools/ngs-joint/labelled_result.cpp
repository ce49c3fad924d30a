#include "labelled_result.h"

#include "ngs/core/error.h"
#include "ngs/problem/region.h"

namespace ngs::joint {
namespace {

/// True if the unsuffixed columns are the complete set of a single object.
bool has_one_set(const io::GaussianPly& ply) {
  const LabelColumns& l = ply.labels;
  return ply.objects.empty() && !l.label.empty() && !l.boundary.empty() && !l.views.empty() && !l.prob.empty();
}

}  // namespace

std::vector<LabelColumns> take_labels(io::GaussianPly& ply, const Scene& scene) {
  const std::size_t wanted = scene.objects.size();
  if (ply.cloud.size() == 0)
    throw Error(ErrorCode::kNothingFound, ply.file.name() + ": the model has no Gaussians, expected some",
                "use a model with Gaussians: ngs-variance scene.json -o boundary.ply");
  if (wanted == 1 && has_one_set(ply)) {  // with several objects the unsuffixed columns are their union
    const std::string& name = scene.objects[0].name;
    if (ply.names_object && ply.object != name)
      throw Error(ErrorCode::kInconsistent,
                  ply.file.name() + ": labelled for object '" + ply.object + "', expected '" + name + "'",
                  "label the other object: ngs-variance scene.json --object NAME -o boundary.ply");
    std::vector<LabelColumns> one;
    one.push_back(std::move(ply.labels));
    return one;
  }
  std::vector<LabelColumns> labels;
  for (const SceneObject& object : scene.objects)
    for (io::NamedLabels& named : ply.objects)
      if (named.object == object.name) labels.push_back(std::move(named.columns));
  if (labels.size() != wanted)
    throw Error(ErrorCode::kBadInput,
                "the model has ngs_ columns for " + std::to_string(labels.size()) + " of the scene's " +
                    std::to_string(wanted) + " objects, expected all of them",
                ply.names_object ? "use its single object: --object '" + ply.object + "'"
                                 : "label the model first: ngs-variance scene.json -o boundary.ply");
  ply.objects.clear();
  ply.labels = {};
  return labels;
}

void write_result(cli::Run& run, const ResultSource& source, const Solution& solution, const std::string& path) {
  const auto timed = run.monitor().scope("write");
  std::vector<io::LabelSet> named;
  for (std::size_t k = 0; k < solution.labels.size(); ++k)
    named.push_back({source.scene.objects[k].name, solution.labels[k]});
  std::vector<float> floater;
  for (std::size_t row = 0; !source.floater.empty() && row < std::size_t(solution.cloud->size()); ++row)
    floater.push_back(source.floater[solution.source_row.empty() ? row : std::size_t(solution.source_row[row])]);
  io::LabelledWrite write;
  if (solution.cloud.get() != &source.ply.cloud) write.edited = solution.cloud.get();
  write.source_row = solution.source_row;
  write.floater = floater;
  io::write_labelled_ply(path, source.ply, named, write);
  for (const auto& [name, value] : solution.figures) run.result()[name] = value;
  run.result()["rows_changed"] = rows_changed(source.ply.cloud, source.labels, solution);
  run.result()["converged"] = solution.converged;
}

}  // namespace ngs::joint
