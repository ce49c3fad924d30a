#include "extractor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "ngs/core/error.h"
#include "ngs/cut/masks/rasterise_prompt.h"
#include "ngs/edit/extract/import_stage.h"
#include "ngs/edit/select/region.h"
#include "ngs/io/formats/write_splat.h"
#include "ngs/orbit/orbit_stage.h"
#include "ngs/render/render_options.h"
#include "ngs/scene/precision/local_origin.h"

namespace ngs::cli {
namespace {

/// The objects of the model, with every column filled: a missing column means that all Gaussians are seen. Without
/// labels, if a region or --activated is given, the whole model is the object.
std::vector<io::NamedLabels> labels_of(const io::GaussianPly& ply, bool may_be_all) {
  std::vector<io::NamedLabels> objects = ply.objects;
  if (objects.empty()) objects = {{ply.object, ply.labels}};
  const std::size_t n = std::size_t(ply.cloud.size());
  for (io::NamedLabels& object : objects) {
    LabelColumns& c = object.columns;
    if (c.label.empty() && c.prob.empty() && may_be_all) c.label.assign(n, 1.f);
    if (c.label.empty() && c.prob.empty() && n > 0)
      throw Error(ErrorCode::kBadInput, ply.file.name() + ": vertex property 'ngs_label' is missing",
                  "label the model first: ngs-variance scene.json -o boundary.ply, or give the place of the object: "
                  "--keep-box, --keep-sphere, --drop-below-plane, --cluster-at, --largest");
    if (c.label.empty()) c.label = c.prob;
    if (c.prob.empty()) c.prob = c.label;
    if (c.views.empty()) c.views.assign(n, 1.f);
    c.variance.resize(n);
    c.boundary.resize(n);
  }
  return objects;
}

/// Indices of the selected objects, in the order of the model.
std::vector<std::size_t> selected(const std::vector<io::NamedLabels>& objects, const std::vector<std::string>& wanted) {
  std::vector<std::string> names;
  for (const io::NamedLabels& object : objects) names.push_back(object.object);
  for (const std::string& name : wanted)
    if (std::ranges::find(names, name) == names.end()) {
      std::string known;
      for (const std::string& n : names) known += (known.empty() ? "" : ", ") + n;
      throw Error(ErrorCode::kUsage, "object = " + name + ", expected one of: " + known);
    }
  std::vector<std::size_t> chosen;
  for (std::size_t k = 0; k < names.size(); ++k)
    if (wanted.empty() || std::ranges::find(wanted, names[k]) != wanted.end()) chosen.push_back(k);
  return chosen;
}

Json counts(const std::string& name, const Extraction& e) {
  return {{"name", name},
          {"object", e.objects},
          {"unseen", e.unseen},
          {"unseen_to_object", e.unseen_to_object},
          {"unusable", e.unusable},
          {"fixed", e.fixed},
          {"components", e.components},
          {"removed_components", e.removed_components},
          {"removed", e.removed}};
}

}  // namespace

Extractor::Extractor(Run& run, io::GaussianPly ply, const ExtractOptions& options, const RegionOptions& region,
                     const SelectOptions& select)
    : run_(run),
      options_(options),
      region_(region),
      unit_(select.unit),
      whole_model_(select.activated && !region.any()),
      ply_(std::move(ply)),
      objects_(labels_of(ply_, region.any() || whole_model_)),
      chosen_(selected(objects_, select.object)) {
  for (const std::string& note : ply_.notes) run_.info(note);
}

void Extractor::import(const std::string& path) {
  if (chosen_.size() != 1)
    throw Error(ErrorCode::kUsage, "import with " + std::to_string(chosen_.size()) + " objects, expected one",
                "choose the edited object: --object NAME");
  const io::GaussianPly edit = io::read_gaussian_ply(path);
  LabelColumns& columns = objects_[chosen_[0]].columns;
  const Extraction before = extract_object(run_.exec(), options_, {ply_.cloud, columns, ply_.fixed});
  const ImportedEdit imported = import_edit(ply_.cloud, before.object, columns.label.values(), edit.cloud, edit.state);
  columns.label = imported.label;
  ply_.fixed = imported.fixed;
  run_.result()["import"] = {{"matched", imported.matched},
                             {"unmatched", imported.unmatched},
                             {"to_object", imported.to_object},
                             {"to_background", imported.to_background}};
  if (imported.by_nearest)
    run_.monitor().warn(path + ": its format rounds positions: " + std::to_string(imported.matched) + " of " +
                        std::to_string(edit.cloud.size()) + " Gaussians were matched by nearest position in the model");
  if (!imported.turned.empty())
    run_.monitor().warn(path + ": turned " + imported.turned +
                        ", as some converters do: matched after turning it back");
  if (imported.unmatched > 0)
    run_.monitor().warn(std::to_string(imported.unmatched) + " Gaussians of the edit are not in the labelled model");
  const std::int64_t background = std::count(before.object.begin(), before.object.end(), std::uint8_t(0));
  if (!imported.by_selection && 2 * imported.to_object > background)
    run_.monitor().warn(
        std::to_string(imported.to_object) + " of the " + std::to_string(background) +
        " Gaussians of the background become object: an edit without a selection must contain only the object");
}

void Extractor::decide() {
  const auto timed = run_.monitor().scope("decide");
  keep_.assign(std::size_t(ply_.cloud.size()), 0);
  for (std::size_t k = 0; k < objects_.size(); ++k) {
    LabelColumns& columns = objects_[k].columns;
    const bool is_chosen = std::find(chosen_.begin(), chosen_.end(), k) != chosen_.end();
    // Imported labels belong to one object: with several, to the selected one.
    const auto fixed = objects_.size() == 1 || (is_chosen && chosen_.size() == 1) ? std::span<const float>(ply_.fixed)
                                                                                  : std::span<const float>();
    const Extraction e = extract_object(run_.exec(), options_, {ply_.cloud, columns, fixed});
    for (std::size_t i = 0; i < keep_.size(); ++i) {
      columns.label[i] = e.object[i];
      if (is_chosen) keep_[i] |= e.object[i];
    }
    run_.result()["objects"].push_back(counts(objects_[k].object, e));
  }
  if (region_.any()) restrict_to_region();
  const std::int64_t kept = std::count(keep_.begin(), keep_.end(), std::uint8_t(1));
  run_.result()["gaussians"] = ply_.cloud.size();
  run_.result()["object"] = kept;
  run_.result()["background"] = ply_.cloud.size() - kept;
  if (needs_local_origin(ply_.cloud)) run_.result()["origin"] = ply_.cloud.origin;
  warn_of_unusual_result(kept);
}

void Extractor::report_plane_selection(const RegionSelection& found) {
  const std::int64_t taken = found.in_shapes - found.above_plane;
  run_.result()["region"]["below_plane"] = taken;
  if (found.in_shapes == 0) return;
  const double percent = 100.0 * double(taken) / double(found.in_shapes);
  run_.text("--drop-below-plane: " + std::to_string(taken) + " of " + std::to_string(found.in_shapes) + " Gaussians (" +
            std::to_string(std::lround(percent)) + " %) lie in the plane or below it\n");
}

void Extractor::restrict_to_region() {
  const auto timed = run_.monitor().scope("region");
  RegionOptions region = region_;
  region.up = up_or(region_.up, ply_.vertical_axis);
  const RegionSelection found =
      with_context(ply_.file.name(), [&] { return select_region(run_.exec(), region, ply_.cloud, keep_); });
  Json& said = run_.result()["region"];
  said = {{"in_shapes", found.in_shapes},
          {"above_plane", found.above_plane},
          {"clusters", found.clusters},
          {"cluster_side", found.cluster_side}};
  if (found.plane.found) {
    const Vec3<double> n = found.plane.normal;
    const std::array<double, 3>& o = ply_.cloud.origin;
    const double offset = found.plane.offset + found.plane.thickness + n.x * o[0] + n.y * o[1] + n.z * o[2];
    said["plane"] = {n.x, n.y, n.z, -offset};
  }
  if (!region_.drop_below_plane.empty()) report_plane_selection(found);
  restrict_to(found.object);
}

void Extractor::restrict_to(std::vector<std::uint8_t> keep) {
  keep_ = std::move(keep);
  for (const std::size_t k : chosen_)
    for (std::size_t i = 0; i < keep_.size(); ++i)
      if (!keep_[i]) objects_[k].columns.label[i] = 0;
}

void Extractor::keep_touched(const std::vector<ViewSums>& strokes) {
  const auto timed = run_.monitor().scope("pieces");
  PieceSelection found = touched_pieces(run_.exec(), ply_.cloud, keep_, strokes);
  for (std::size_t i = 0; i < ply_.fixed.size(); ++i)  // final labels
    if (ply_.fixed[i] == 1 && keep_[i]) found.object[i] = 1;
  const std::int64_t kept = std::count(found.object.begin(), found.object.end(), std::uint8_t(1));
  found.needles = std::min(found.needles, std::count(keep_.begin(), keep_.end(), std::uint8_t(1)) - kept);
  found.removed = std::count(keep_.begin(), keep_.end(), std::uint8_t(1)) - kept - found.needles;
  run_.result()["pieces"] = {
      {"found", found.pieces}, {"touched", found.kept_pieces}, {"left_out", found.removed}, {"needles", found.needles}};
  run_.result()["object"] = kept;
  run_.result()["background"] = ply_.cloud.size() - kept;
  if (found.removed > 0)
    run_.text("left out: " + std::to_string(found.removed) + " Gaussians of " +
              std::to_string(found.pieces - found.kept_pieces) +
              " components that no stroke on the object touches; leave --strokes out to keep them\n");
  if (found.needles > 0)
    run_.text("trimmed: " + std::to_string(found.needles) +
              " long thin Gaussians that stick out of the object where it was cut; leave --strokes out to keep them\n");
  restrict_to(std::move(found.object));
}

void Extractor::warn_of_unusual_result(std::int64_t kept) {
  if (kept == 0)
    run_.nothing_found(
        "no Gaussian is object by rule " + options_.rule +
            (options_.min_component > 0 ? " and --min-component " + std::to_string(options_.min_component) : "") +
            (region_.any() ? " within the given region" : ""),
        region_.any() ? "widen the region: the report lists the count after each of its options"
                      : "lower the threshold, or check the masks: ngs-scene check scene.json");
  if (ply_.health.excluded() > 0)
    run_.monitor().warn(std::to_string(ply_.health.excluded()) +
                        " Gaussians have values that are not finite or out of range: they stay in the background "
                        "unchanged, and some viewers reject them");
  if (kept == ply_.cloud.size() && kept > 0 && !whole_model_)
    run_.monitor().warn("every Gaussian is object: the background is empty");
}

std::vector<const io::NamedLabels*> Extractor::chosen() const {
  std::vector<const io::NamedLabels*> labels;
  for (const std::size_t k : chosen_) labels.push_back(&objects_[k]);
  return labels;
}

void Extractor::write(const std::string& path, const std::vector<std::uint8_t>& keep,
                      const GaussianCloud* edited) const {
  const auto up = region_.up == UpAxis::kAuto ? std::nullopt : std::optional(orbit::axis_of(region_.up));
  for (const std::string& note : io::write_splat(path, {ply_, keep, edited, up, unit_})) run_.monitor().warn(note);
}

void Extractor::write_background(const std::string& path) const {
  std::vector<std::uint8_t> rest(keep_.size());
  for (std::size_t i = 0; i < rest.size(); ++i) rest[i] = !keep_[i];
  write(path, rest);
}

void Extractor::write_labelled(const std::string& path, bool with_state) const {
  io::LabelledWrite options{.fixed = ply_.fixed};
  if (with_state) options.state = keep_;
  io::write_labelled_ply(path, ply_, objects_, options);
}

void check_strokes(Run& run, const Inputs& strokes, const Input& scene) {
  if (strokes && !scene) throw Error(ErrorCode::kUsage, "--strokes needs the cameras", "give --scene scene.json");
  if (!strokes) run.warn_unused({"--view"}, "without --strokes");
}

std::vector<ViewSums> stroke_weights_of(const Run& run, const Scene& scene, const Marks& marks,
                                        const GaussianCloud& cloud) {
  const SplatOptions splat = prepared_for(run.exec(), splat_options({}, cloud, scene), cloud);
  std::vector<ViewSums> strokes;
  for (const auto& [view, hand] : marks) {
    const Camera& camera = scene.views[view].camera;
    const ViewPrompt prompt = rasterise(hand, camera.width_px, camera.height_px);
    for (ViewSums& stroke : stroke_weights(run.exec(), cloud, camera, prompt, splat))
      strokes.push_back(std::move(stroke));
  }
  return strokes;
}

}  // namespace ngs::cli
