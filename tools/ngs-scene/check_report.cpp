#include "check_report.h"

#include "ngs/core/formatted.h"
#include "shared/text/layout.h"

namespace ngs::scene_tool {
namespace {

Json view_json(const SceneView& view, const ViewCheck& check, bool has_model) {
  Json out{{"name", view.camera.name}, {"split", view.split == Split::kTrain ? "train" : "held-out"}};
  if (has_model) {
    out["in_front"] = check.in_front;
    out["inside"] = check.inside;
  }
  if (check.match) {
    out["psnr_db"] = check.match->psnr_db;
    out["constant_db"] = check.match->constant_db;
    out["fit_db"] = check.match->gain_db();
    out["covered"] = check.match->covered;
  }
  if (check.masks) {
    out["coverage"] = check.masks->coverage;
    out["known"] = check.masks->known;
  }
  return out;
}

std::string table_row(const SceneView& view, const ViewCheck& check, bool has_model) {
  std::string text = cli::padded(view.camera.name, 22);
  text += view.split == Split::kTrain ? "train      " : "held-out   ";
  text +=
      has_model ? formatted("%-10.3f", check.in_front) + formatted("%-10.3f", check.inside) : "-         -         ";
  text += check.match ? formatted("%-9.2f", check.match->psnr_db) + formatted("%-9.2f", check.match->gain_db())
                      : "-        -        ";
  if (!check.masks) return text + "-\n";
  for (const double share : check.masks->coverage) text += formatted("%.4f ", share);
  text.back() = '\n';
  return text;
}

}  // namespace

Json import_json(const io::ImportedScene& imported) {
  Json out{{"format", imported.format},
           {"cameras", imported.cameras_file},
           {"images", imported.images_dir},
           {"masks", imported.masks_dir},
           {"truth", imported.truth_dir},
           {"model_path", imported.scene.model_path},
           {"mask_rules", imported.views_by_mask_rule},
           {"views", imported.scene.views.size()}};
  if (const io::UnfitMasks& unfit = imported.unfit_masks; !unfit.found.empty())
    out["unfit_masks"] = {{"found", unfit.found}, {"remedy", unfit.remedy}};
  return out;
}

Json check_json(const Scene& scene, const SceneCheck& check) {
  const bool has_model = check.sampled_gaussians > 0;
  Json out;
  int compared = 0, masks = 0;
  for (const ViewCheck& view : check.views) {
    compared += view.match.has_value();
    masks += view.masks.has_value();
  }
  out["views"] = scene.views.size();
  out["compared_views"] = compared;
  out["mask_views"] = masks;
  if (has_model) {
    out["median_inside"] = check.median_inside;
    out["sampled_gaussians"] = check.sampled_gaussians;
  }
  if (compared > 0) {
    out["median_psnr_db"] = check.median_psnr_db;
    out["median_fit_db"] = check.median_fit_db;
  }
  for (std::size_t k = 0; k < scene.objects.size(); ++k) {
    const ObjectCheck& o = check.objects[k];
    out["objects"].push_back({{"name", scene.objects[k].name},
                              {"id", scene.objects[k].id},
                              {"views", o.views},
                              {"empty", o.empty},
                              {"full", o.full},
                              {"mean_coverage", o.mean_coverage},
                              {"border", o.border}});
  }
  for (const std::size_t view : check.uniform_masks.contradicted)
    out["lost_masks"].push_back(scene.views[view].camera.name);
  for (std::size_t i = 0; i < scene.views.size(); ++i)
    out["per_view"].push_back(view_json(scene.views[i], check.views[i], has_model));
  return out;
}

Json health_json(const CloudHealth& health) {
  return {{"gaussians", health.total},
          {"non_finite", health.non_finite},
          {"absurd_scale", health.absurd_scale},
          {"zero_rotation", health.zero_rotation}};
}

std::string check_table(const Scene& scene, const SceneCheck& check) {
  constexpr std::size_t kMaxRows = 12;
  const bool shortened = scene.views.size() > kMaxRows;
  std::string text = "view                  split      in front  inside    PSNR dB  fit dB   coverage\n";
  for (std::size_t i = 0; i < scene.views.size(); ++i)
    if (!shortened || check.views[i].match)
      text += table_row(scene.views[i], check.views[i], check.sampled_gaussians > 0);
  if (shortened)
    text +=
        "(only views compared with their photos, of " + std::to_string(scene.views.size()) + " views; all: --report)\n";
  return text;
}

}  // namespace ngs::scene_tool
