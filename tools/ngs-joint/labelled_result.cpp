#include "labelled_result.h"

#include <algorithm>

#include "ngs/capture/view_shares.h"
#include "ngs/core/error.h"
#include "ngs/problem/coarse_input.h"
#include "ngs/problem/region.h"
#include "ngs/problem/view_list.h"
#include "shared/scene/scene_model.h"

namespace ngs::joint {
namespace {

/// True if the unsuffixed columns are the complete set of a single object.
bool has_one_set(const io::GaussianPly& ply) {
  const LabelColumns& l = ply.labels;
  return ply.objects.empty() && !l.label.empty() && !l.boundary.empty() && !l.views.empty() && !l.prob.empty();
}

/// Photos cached at the working size and at the size of decisions, and renders at the latter.
double photo_cache_bytes(const Scene& scene) {
  constexpr double kMaxCacheBytes = 256 * cli::kMib;  // bytes per cache
  double px = 0;
  for (const std::size_t v : photo_views(scene)) px += cli::view_px(scene.views[v]);
  const double fewer = decision_shrink(scene) * decision_shrink(scene);
  return std::min(kMaxCacheBytes, 12 * px) + std::min(kMaxCacheBytes, 12 * px / fewer) +
         std::min(kMaxCacheBytes, 16 * px / fewer);
}

/// Photos and masks of the training views during the steps, and the images of one step.
double step_picture_bytes(const Problem& problem) {
  constexpr double kMaxCacheBytes = 512 * cli::kMib;
  constexpr double kBytesPerPx = 900;  // of the losses, and of contour refinement at twice the size
  double px = 0;
  for (const std::size_t v : problem.views) px += cli::view_px(problem.scene.views[v]);
  return std::min(kMaxCacheBytes, (12 + 4.0 * double(problem.labels.size())) * px) +
         kBytesPerPx * cli::largest_view_px(problem.scene);
}

/// Trained parameters: values, gradients and two Adam moments of the rows in the region.
double trained_bytes(const Problem& problem) {
  const std::vector<std::uint8_t> region = region_of(problem.labels);
  const auto rows = double(std::ranges::count(region, std::uint8_t(1)));
  return rows * 4 * 4 * (14 + 3.0 * problem.cloud.rest_count() + double(problem.labels.size()));
}

/// Largest fraction of Gaussians inside a view, over at most kViews training views.
double visible_share(const Problem& problem) {
  constexpr std::size_t kViews = 8;
  const std::vector<std::int64_t> sample = sample_usable(problem.cloud);
  double most = 0;
  for (const std::size_t v : spread_views(problem.views, sample.empty() ? 0 : kViews))
    most = std::max(most, view_shares(problem.cloud, problem.scene.views[v].camera, sample).inside);
  return most;
}

/// Bytes per visible Gaussian of a forward and backward pass with so many channels.
double pass_bytes(double channels) { return 2 * cli::kVisibleBytes + cli::kTilesReached * (20 + 4 * channels); }

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
  ply.objects.clear(), ply.labels = {};
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
  write.source_row = solution.source_row, write.floater = floater;
  io::write_labelled_ply(path, source.ply, named, write);
  for (const auto& [name, value] : solution.figures) run.result()[name] = value;
  run.result()["rows_changed"] = rows_changed(source.ply.cloud, source.labels, solution);
  run.result()["converged"] = solution.converged;
}

Json memory_plan(const Problem& problem) {
  const auto n = double(problem.cloud.size()), objects = double(problem.labels.size());
  const double owners = std::min(objects, 2.0), shown = visible_share(problem);
  const double model = cli::model_bytes(problem.cloud), drawn = model + cli::kPreparedBytes;
  const double read = drawn + 4 + cli::label_bytes(owners);
  const double evidence =
      32 + 64 * owners + 4 * (objects + 1) + 12;         // of all views; of other objects' labels; of one view
  const double search = drawn + 16 + 8 + 1 + 3 * 8 + 2;  // search for floaters, and the model without them
  const double labels_alone = read + evidence + search + shown * pass_bytes(objects + 3);
  const double steps =
      labels_alone + drawn + 4 * objects + shown * 4 * 12 * cli::kTilesReached;  // values and gradients
  const double pictures = photo_cache_bytes(problem.scene);
  return {{"visible_share", shown},
          {"bytes_per_gaussian", labels_alone},
          {"bytes_per_gaussian_with_steps", steps},
          {"estimated_peak_mib", cli::peak_mib(labels_alone * n + pictures)},
          {"estimated_peak_mib_with_steps",
           cli::peak_mib(steps * n + trained_bytes(problem) + pictures + step_picture_bytes(problem))}};
}

}  // namespace ngs::joint
