#include "variance_output.h"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <map>
#include <set>

#include "ngs/core/error.h"
#include "ngs/core/formatted.h"
#include "ngs/core/listed.h"
#include "ngs/io/files/content_hash.h"
#include "ngs/io/files/mapped_file.h"
#include "ngs/io/files/shell_word.h"
#include "ngs/io/image/exr.h"
#include "ngs/io/image/masks.h"
#include "ngs/io/scene/scene_json.h"
#include "ngs/ops/optim/resident.h"
#include "ngs/options/name_of.h"
#include "ngs/problem/view_list.h"
#include "ngs/render/render_options.h"
#include "ngs/scene/view_names.h"
#include "shared/scene/scene_model.h"

namespace ngs::variance {
namespace {

std::string scene_identity(const std::string& path) { return "scene " + io::content_hash(path).xxh3; }

/// The scene with the objects of the evidence, in column order.
Scene with_columns(Scene scene, const std::vector<std::string>& columns, const std::string& path) {
  const auto refuse = [](const std::string& what) {
    throw Error(ErrorCode::kInconsistent, what, "write the parts again from this scene");
  };
  if (columns.empty()) refuse(path + ": the parts have no object, expected at least one object of the scene");
  std::vector<SceneObject> objects;
  for (const std::string& name : columns) {
    const auto named = [&](const SceneObject& o) { return o.name == name; };
    const auto known = std::find_if(scene.objects.begin(), scene.objects.end(), named);
    if (known == scene.objects.end())
      refuse(path + ": no object '" + name + "', expected it because the parts have evidence of it");
    if (std::any_of(objects.begin(), objects.end(), named))
      refuse("object '" + name + "' is in the parts twice, expected once");
    objects.push_back(*known);
  }
  scene.objects = std::move(objects);
  return scene;
}

/// Adds the counts to the report; returns the number of boundary Gaussians of all objects.
std::int64_t report_counts(cli::Run& run, const LabelledScene& labelled) {
  const auto& [scene, ply, labels, weight, rule] = labelled;
  const auto count = [](const LabelColumn& column) { return std::count(column.begin(), column.end(), 1.f); };
  std::int64_t boundary_total = 0;
  for (std::size_t k = 0; k < labels.size(); ++k) {
    const std::int64_t boundary = count(labels[k].boundary);
    boundary_total += boundary;
    run.result()["objects"].push_back(
        {{"name", scene.objects[k].name}, {"boundary", boundary}, {"object", count(labels[k].label)}});
  }
  run.result()["gaussians"] = ply.cloud.size();
  run.result()["excluded"] = ply.health.excluded();
  run.result()["never_seen"] = std::count(labels[0].views.begin(), labels[0].views.end(), 0.f);
  run.result()["boundary"] = boundary_total;
  return boundary_total;
}

}  // namespace

std::vector<std::size_t> shard_of(const std::vector<std::size_t>& views, const std::string& shard) {
  std::size_t i = 0, n = 0;
  const char *begin = shard.data(), *end = begin + shard.size();
  const auto first = std::from_chars(begin, end, i);
  const bool slash = first.ec == std::errc() && first.ptr != end && *first.ptr == '/';
  const auto second = slash ? std::from_chars(first.ptr + 1, end, n) : first;
  constexpr std::size_t kMaxShards = std::size_t(1) << 20;
  if (!slash || second.ec != std::errc() || second.ptr != end || i >= n || n > kMaxShards)
    throw Error(ErrorCode::kUsage, "--shard: '" + shard + "', expected i/N with 0 <= i < N", "for example --shard 0/8");
  const auto bound = [&](std::size_t k) { return views.begin() + std::ptrdiff_t(views.size() * k / n); };
  return {bound(i), bound(i + 1)};
}

std::string made_with(const std::string& scene_path, const SplatOptions& splat) {
  return scene_identity(scene_path) + ", --compat " + name_of(kCompatNames, splat.compat) + ", --antialias " +
         (splat.antialiased ? "on" : "off");
}

Json memory_plan(const GaussianCloud& cloud, const Scene& scene, std::size_t views) {
  const auto objects = double(scene.objects.size()), n = double(cloud.size());
  const double owners = std::min(objects, 2.0);  // upper bound on the mean number of objects per Gaussian
  const double few = std::min(objects, 3.0);     // with more objects, sums exist only for those visible in a tile
  const double sums = 32 + 64 * owners;          // Evidence
  const double repairs = 240;                    // evidence of repaired masks (check_masks), as measured
  // One view at a time, as if every Gaussian were visible: sums of the view; lists, entries and sums of the pairs.
  const double view = cli::kVisibleBytes + 4 + 8 * (2 + 2 * few) + cli::kTilesReached * (8 + 12 + 4 * (2 + 2 * few));
  const double labels = cli::label_bytes(owners);  // written after the last view
  const double per_gaussian = cli::model_bytes(cloud) + sums + repairs + std::max(cli::kPreparedBytes + view, labels);
  const double per_pixel = 1 + 4 * objects + 8;  // masks, and the decoded image
  return {{"views", views},
          {"gaussians", cloud.size()},
          {"bytes_per_gaussian", per_gaussian},
          {"bytes_per_pixel", per_pixel},
          {"estimated_peak_mib", cli::peak_mib(per_gaussian * n + per_pixel * cli::largest_view_px(scene))}};
}

Scene scene_of(cli::Run& run, const io::EvidencePart& sum, const std::string& given) {
  const std::string& path = given.empty() ? sum.scene_path : given;
  if (path.empty())
    throw Error(ErrorCode::kUsage, "the parts name no scene, because it was read from a pipe",
                "give it with --scene scene.json");
  if (given.empty()) {
    io::require_regular_file(path);
    run.add_input("scene", path);
  }
  Scene scene = with_columns(io::read_scene_json(path), sum.objects, path);
  if (const std::string made_from = scene_identity(path); !sum.made_with.starts_with(made_from + ","))
    throw Error(ErrorCode::kInconsistent,
                path + ": is " + made_from + ", but the parts were made with " + sum.made_with,
                "give the scene.json of the parts, or make them again from this one");
  cli::require_model(run, scene, path);
  return scene;
}

void check_complete(const io::EvidencePart& sum, const Scene& scene) {
  if (io::content_hash(scene.model_path).xxh3 != sum.model_hash)
    throw Error(ErrorCode::kInconsistent, scene.model_path + ": not the model of the parts", "write the parts again");
  std::set<std::string> missing;
  for (const std::size_t view : training_views(scene)) missing.insert(scene.views[view].camera.name);
  for (const std::string& view : sum.views)
    if (missing.erase(view) == 0)
      throw Error(ErrorCode::kInconsistent, "view '" + view + "' is no training view of the scene");
  if (!missing.empty())
    throw Error(
        ErrorCode::kInconsistent,
        std::to_string(missing.size()) + " training views are in no part, the first view is '" + *missing.begin() + "'",
        "merge the parts of all shards");
}

LabelledScene label(const BoundaryRule& rule, const Scene& scene, const io::GaussianPly& ply, Evidence&& evidence) {
  const Evidence from = std::move(evidence);
  return {scene, ply, label_gaussians(rule, from), from.weights(), rule};
}

void write_labels(cli::Run& run, const LabelledScene& labelled, const std::string& path) {
  const auto timed = run.monitor().scope("write");
  const auto& [scene, ply, labels, weight, rule] = labelled;
  const std::int64_t boundary = report_counts(run, labelled);
  const bool any_evidence = std::any_of(labels.begin(), labels.end(), [](const LabelColumns& l) {
    return std::any_of(l.views.begin(), l.views.end(), [](float views) { return views > 0; });
  });
  if (!any_evidence)
    run.nothing_found("no mask of a training view shows any Gaussian",
                      "masks of held-out views are not used; list the masks found: ngs-scene check scene.json; make "
                      "masks with ngs-mask, and import the scene again with --masks DIR");
  else if (boundary == 0)
    run.nothing_found("no Gaussian has a normalised mask variance above tau = " + std::to_string(rule.tau),
                      "lower --tau, or check the masks: ngs-scene check scene.json");
  std::vector<io::LabelSet> named;
  for (std::size_t k = 0; k < labels.size(); ++k) named.push_back({scene.objects[k].name, labels[k]});
  io::LabelledWrite columns{.weight = weight, .rule = rule};
  io::write_labelled_ply(path, ply, named, columns);
}

void write_exr(cli::Run& run, const LabelledScene& labelled, const SplatOptions& options, const std::string& folder) {
  const auto timed = run.monitor().scope("exr");
  const Scene& scene = labelled.scene;
  const GaussianCloud& cloud = labelled.ply.cloud;
  const SplatOptions splat = prepared_for(run.exec(), options, cloud);
  const LabelColumns& first = labelled.labels.front();
  std::vector<float> channels;
  for (std::size_t i = 0; i < first.label.size(); ++i)
    channels.insert(channels.end(), {first.label[i], first.prob[i], first.variance[i], first.boundary[i]});
  Resident resident(run.exec());
  resident.add_input(channels);
  const std::vector<std::string> names = output_names(scene.views);
  for (const std::size_t view : training_views(scene)) {
    RenderRequest request{.label = {channels.data(), cloud.size(), 4}};
    const Camera& camera = scene.views[view].camera;
    const RenderedView rendered = render(run.exec(), cloud, camera, splat, request);
    io::ExrImage image;
    image.width_px = rendered.width_px;
    image.height_px = rendered.height_px;
    image.add({"R", "G", "B"}, rendered.colour);
    image.add({"A"}, rendered.alpha);
    image.add({"ngs.mask", "ngs.prob", "ngs.variance", "ngs.boundary"}, rendered.label);
    image.text["ngs:schema"] = "ngs.variance.1";
    const std::filesystem::path file = std::filesystem::path(folder) / (names[view] + ".exr");
    std::filesystem::create_directories(file.parent_path());
    io::write_exr(file.generic_string(), image);
  }
}

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kNamed = 4;  // views or objects in a message
constexpr const char* kGoOn = "; to go on with these masks: --min-mask-agreement -1";

std::string iou(double value) { return formatted("%.2f", value); }

/// The folder that holds all masks, and the ending of the first one.
struct MaskFiles {
  fs::path folder;
  std::string ending;
};

MaskFiles files_of(const Scene& scene) {
  MaskFiles files;
  for (const SceneView& view : scene.views) {
    if (view.mask_path.empty()) continue;
    const fs::path folder = fs::path(view.mask_path.substr(0, view.mask_path.find("{object}"))).parent_path();
    if (files.ending.empty()) files = {folder, fs::path(view.mask_path).extension().string()};
    while (!files.folder.empty() &&
           std::mismatch(files.folder.begin(), files.folder.end(), folder.begin(), folder.end()).first !=
               files.folder.end())
      files.folder = files.folder.parent_path();
  }
  return files;
}

[[noreturn]] void refuse_repairable(const Scene& scene, const RepairedAgreement& best) {
  const MaskFiles files = files_of(scene);
  const std::string folder = files.folder.empty() ? "." : files.folder.generic_string();
  const MaskRepair& repair = best.repair;
  std::string remedy = "name each mask after its photo";
  if (repair.shift != 0) remedy = "import the scene again with --mask-shift " + std::to_string(repair.shift);
  if (repair.stretch == 2) remedy = "keep every second mask, and import the scene again with --masks-in-order";
  if (repair.inverted)
    remedy = "import the scene again " + std::string(scene.mask_invert ? "without" : "with") + " --mask-invert";
  else if (repair.mogrify)
    remedy = "turn them with ImageMagick: find " + io::shell_word(folder) + " -name '*" + files.ending +
             "' -exec mogrify " + repair.mogrify + " {} +";
  throw Error(ErrorCode::kInconsistent,
              folder + ": the masks look " + repair.mistake + ", labels made from them match them with IoU " +
                  iou(best.before) + ", and with " + iou(best.after) +
                  " if that is undone, expected masks of their views",
              remedy + kGoOn);
}

/// What single masks look like, and the command that undoes it.
std::pair<std::string, std::string> single_mistakes(const Scene& scene, const MaskAgreement& found) {
  std::map<std::string, std::pair<std::vector<std::string>, std::string>> by_mistake;  // views, command
  for (const auto& [view, repair] : found.single) {
    auto& [names, command] = by_mistake[repair.mistake];
    if (names.empty()) command = std::string("mogrify ") + repair.mogrify;
    names.push_back(scene.views[view].camera.name);
    command += " " + io::shell_word(io::mask_files(scene, view)[0]);
  }
  std::string mistakes, commands;
  for (const auto& [mistake, of] : by_mistake) {
    mistakes += (mistakes.empty() ? "" : "; ") + listed(of.first, kNamed) + " " + mistake;
    commands += (commands.empty() ? "" : "; ") + of.second;
  }
  return {"masks: labels made from them match them with IoU " + iou(found.given) + ", and with " +
              iou(found.single_after) + " if mistakes of " + std::to_string(found.single.size()) + " of " +
              std::to_string(found.views) + " masks are undone (" + mistakes + ")",
          "undo them with ImageMagick: " + commands};
}

[[noreturn]] void refuse_ids(const Scene& scene, const MaskAgreement& found) {
  std::vector<std::string> names;
  for (const std::size_t k : found.low) names.push_back(scene.objects[k].name);
  throw Error(
      ErrorCode::kInconsistent,
      listed(names, kNamed) + ": their masks contradict from view to view (IoU " + iou(found.alone) + " alone, " +
          iou(found.together) + " as one object), expected one id per object in all views",
      std::string("ids need tracking: make the masks with a tracker, such as SAM 2 on the photos as a video") + kGoOn);
}

}  // namespace

void check_masks(cli::Run& run, const MaskAgreementOptions& options, const EvidenceInputs& in) {
  if (options.min_mask_agreement < 0) return;
  const MaskAgreement found = measure_mask_agreement(run.exec(), run.monitor(), in);
  if (found.views == 0 || run.monitor().stop_requested()) return;
  Json& json = run.result()["mask_agreement"];
  json = {{"views", found.views}, {"given", found.given}};
  for (const RepairedAgreement& r : found.repaired)
    json["repaired"][r.repair.mistake] = {{"views", r.views}, {"before", r.before}, {"after", r.after}};
  if (!found.objects.empty()) json["objects"] = found.objects;
  if (!found.low.empty()) {
    json["alone"] = found.alone;
    json["together"] = found.together;
  }
  const auto [what, remedy] = single_mistakes(in.scene, found);
  switch (found.verdict(options)) {
    case MaskVerdict::kFit:
      if (!found.single.empty()) run.monitor().warn(what + "; " + remedy);
      return;
    case MaskVerdict::kRepairable:
      if (found.single.empty() || found.single_after <= found.repair_that_fits()->after)
        refuse_repairable(in.scene, *found.repair_that_fits());
      break;
    case MaskVerdict::kIdsContradict: refuse_ids(in.scene, found);
    case MaskVerdict::kContradict: break;
  }
  if (!found.single.empty())
    throw Error(ErrorCode::kInconsistent, what + ", expected masks of their views", remedy + kGoOn);
  const bool is_low = found.given < options.min_mask_agreement;
  throw Error(ErrorCode::kInconsistent,
              "masks: labels made from them match them with IoU " + iou(found.given) + " in " +
                  std::to_string(found.views) + " views, expected " +
                  (is_low ? "at least " + iou(options.min_mask_agreement)
                          : "less with the masks of other views: they are " + found.best()->repair.mistake + " with " +
                                iou(found.best()->after)),
              std::string("see which masks are wrong: ngs-scene check SCENE --sheet masks.html") + kGoOn);
}

}  // namespace ngs::variance
