#include "fill_output.h"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <numeric>

#include "ngs/io/capture/sparse_points.h"
#include "ngs/io/formats/write_splat.h"
#include "ngs/io/image/image_file.h"
#include "ngs/io/image/masks.h"
#include "ngs/io/ply/gaussian_columns.h"
#include "ngs/io/scene/scene_json.h"
#include "ngs/ops/image/image_bytes.h"
#include "ngs/options/name_of.h"
#include "ngs/problem/cloud_rows.h"
#include "ngs/render/render_options.h"
#include "ngs/scene/view_names.h"
#include "shared/scene/scene_model.h"

namespace ngs::cli {
namespace {

constexpr NamedValue<TextureFill> kTextureNames[] = {
    {TextureFill::kNothing, "none"}, {TextureFill::kSmooth, "smooth"}, {TextureFill::kPatches, "patches"}};

Json surface_report(const FilledSurface& s) {
  return {{"kind", s.is_plane ? "plane" : "surface"},
          {"normal", {s.normal.x, s.normal.y, s.normal.z}},
          {"rim_points", s.rim_points},
          {"residual", s.residual},
          {"spacing", s.spacing},
          {"cell_side", s.cell_side},
          {"cells", s.cells},
          {"one_sided_cells", s.one_sided},
          {"continued_cells", s.continued},
          {"footprint_cells", s.footprint.cells},
          {"footprint_filled", s.footprint.filled},
          {"footprint_covered", s.footprint.covered},
          {"shadow_left", s.shadow.shadow_factor},
          {"texture", name_of(kTextureNames, s.texture)},
          {"rows", s.rows}};
}

/// What became of the object's footprint on all surfaces, one clause.
std::string coverage(const HoleFill& fill) {
  Footprint all;
  for (const FilledSurface& s : fill.surfaces) {
    all.cells += s.footprint.cells;
    all.filled += s.rows > 0 ? s.footprint.filled : 0;
    all.covered += s.footprint.covered;
  }
  if (all.cells == 0) return "the object stands on no surface";
  const auto percent = [&](std::int64_t n) { return std::to_string(100 * n / all.cells) + " %"; };
  return "of the object's footprint " + percent(all.filled) + " filled, " + percent(all.covered) +
         " covered by the background before, " + percent(all.cells - all.filled - all.covered) + " open" +
         (fill.relit_rows > 0 ? "; " + std::to_string(fill.relit_rows) + " Gaussians in its shadow relit" : "");
}

/// The background without the removed rows, and with the added ones at its end.
GaussianCloud filled_background(const Exec& exec, const Extractor& extractor, const HoleFill& fill) {
  std::vector<std::int64_t> rows;
  for (std::size_t i = 0; i < fill.removed.size(); ++i)
    if (!extractor.object()[i] && !fill.removed[i]) rows.push_back(std::int64_t(i));
  GaussianCloud cloud = gather_rows(exec, extractor.cloud(), rows);
  const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
  const GaussianCloud& added = fill.filled;
  append(cloud.position, added.position);
  append(cloud.rotation, added.rotation);
  append(cloud.log_scale, added.log_scale);
  append(cloud.logit_opacity, added.logit_opacity);
  append(cloud.sh_dc, added.sh_dc);
  append(cloud.sh_rest, added.sh_rest);
  append(cloud.usable, added.usable);
  return cloud;
}

constexpr const char* kPictures[] = {"images", "holes", "dilated"};
constexpr const char* kOtherFiles[] = {"background.ply", "sparse/0/cameras.txt", "sparse/0/images.txt",
                                       "sparse/0/points3D.txt"};

ImageU8 picture_of(const PixelMask& mask, const Camera& camera) {
  ImageU8 out(camera.width_px, camera.height_px, 1);
  for (std::size_t p = 0; p < mask.size(); ++p) out.data[p] = mask[p] ? 255 : 0;
  return out;
}

/// The file of a view, relative to the folder.
std::string picture_file(const std::string& folder, const char* kind, const std::string& name) {
  return folder + "/" + kind + "/" + name + ".png";
}

}  // namespace

void check_fill_options(Run& run, const FillOptions& options, const Input& inpainted, const Input& scene,
                        const Outputs& out) {
  if (inpainted && !scene) throw Error(ErrorCode::kUsage, "--inpainted needs the cameras", "give --scene scene.json");
  if (inpainted && !out.background_filled && !out.filled)
    throw Error(ErrorCode::kUsage, "--inpainted changes only the filled background",
                "give --background-filled FILE or --filled FILE");
  if (out.filled && options.fill == FillKind::kOff)
    throw Error(ErrorCode::kUsage, "--filled with --fill off", "leave --fill off out");
  if (!out.background_filled && !out.filled) run.warn_unused({"--fill"}, "without --background-filled or --filled");
}

FillOutput::FillOutput(Run& run, const Extractor& extractor, FillOptions options, InpaintedPictures* inpainted)
    : run_(run), extractor_(extractor) {
  if (options.fill == FillKind::kOff) return;
  fill_ = fill_hole(run.exec(), run.monitor(), options, {extractor.cloud(), extractor.object()}, run.seed());
  background_ = filled_background(run.exec(), extractor, *fill_);
  kept_ = std::size_t(background_.size() - fill_->filled.size());
  report(options);
  if (inpainted != nullptr) refit(*inpainted);
  const std::int64_t added = background_.size() - std::int64_t(kept_) - fill_->relit_rows;
  run.result()["fill"] = report_;
  if (added == 0) run.result()["fill"]["nothing"] = fill_->nothing;
  run.text((added > 0 ? "filled the hole: " + std::to_string(added) + " Gaussians added (" +
                            (inpainted != nullptr ? "from inpainted pictures" : "invented, not measured") + "), " +
                            std::to_string(fill_->removed_rows) + " removed"
                      : "filled nothing: " + fill_->nothing) +
           "; " + coverage(*fill_) + "\n");
}

void FillOutput::report(const FillOptions& options) {
  Json surfaces = Json::array();
  for (const FilledSurface& s : fill_->surfaces) surfaces.push_back(surface_report(s));
  report_ = {{"kind", name_of(kFillNames, options.fill)},
             {"seed", run_.seed()},
             {"rows_added", background_.size() - std::int64_t(kept_) - fill_->relit_rows},
             {"rows_removed", fill_->removed_rows},
             {"rows_relit", fill_->relit_rows},
             {"coverage", coverage(*fill_)},
             {"surfaces", surfaces}};
}

void FillOutput::refit(InpaintedPictures& inpainted) {
  inpainted.find_holes(run_, extractor_);
  const InpaintedViews views = inpainted.views(run_, background_);
  const HoleRefit found = refit_hole(run_.exec(), run_.monitor(), views, kept_, background_);
  report_["rows_added"] = background_.size() - std::int64_t(kept_) - fill_->relit_rows;
  report_["inpainted"] = {{"views", views.views.size()},
                          {"rows_by_depth", found.seeds},
                          {"psnr_before_db", found.psnr_before_db},
                          {"psnr_after_db", found.psnr_after_db}};
}

std::vector<std::string> FillOutput::comments() const {
  std::vector<std::string> comments = io::render_comments(extractor_.model());
  comments.push_back("ngs-fill " + report_.dump());
  return comments;
}

/// Rows from `kept` on are marked as filled.
void FillOutput::write_rows(const std::string& path, const GaussianCloud& cloud, std::size_t kept) const {
  std::vector<float> filled(std::size_t(cloud.size()));
  std::fill(filled.begin() + std::ptrdiff_t(kept), filled.end(), 1.f);
  const io::AddedColumn column{std::string(io::kFilledColumn), filled};
  if (io::output_format(path) != io::SplatFormat::kPly) return extractor_.write(path, {}, &cloud);
  std::vector<std::string> notes = io::write_splat(path, cloud, {}, comments(), column);
  notes.push_back(io::note_of_left_columns(path, extractor_.model()));
  for (const std::string& note : notes)
    if (!note.empty()) run_.monitor().warn(note);
}

void FillOutput::write(const Outputs& out) const {
  if (out.background) extractor_.write_background(out.background.path);
  std::vector<std::int64_t> added(std::size_t(background_.size()) - kept_);  // none without a fill
  if (out.background_filled && !added.empty()) write_rows(out.background_filled.path, background_, kept_);
  if (out.background_filled && added.empty()) {
    std::error_code absent;
    std::filesystem::remove(out.background_filled.path, absent);
  }
  if (!out.filled) return;
  std::iota(added.begin(), added.end(), std::int64_t(kept_));
  write_rows(out.filled.path, gather_rows(run_.exec(), background_, added), 0);
}

void check_inpaint_options(Run& run, const Output& inpaint, const Input& inpainted, const Input& scene) {
  if (inpaint && !scene) throw Error(ErrorCode::kUsage, "--inpaint needs the cameras", "give --scene scene.json");
  if (!inpaint && !inpainted) run.warn_unused({"--inpaint-dilate-px"}, "without --inpaint or --inpainted");
}

void check_inpaint_folder(const Scene& scene, const std::string& scene_path, const std::string& folder,
                          std::vector<std::string> inputs) {
  std::error_code ignored;
  if (std::filesystem::equivalent(folder + "/scene.json", scene_path, ignored))
    throw Error(ErrorCode::kUsage, folder + ": is the folder of the scene, whose files would be replaced",
                "choose another folder for --inpaint");
  std::vector<std::string> files;
  for (const char* name : kOtherFiles) files.push_back(folder + "/" + name);
  for (const std::string& name : output_names(scene.views))
    for (const char* kind : kPictures) files.push_back(picture_file(folder, kind, name));
  refuse_over_photos(scene, files);
  inputs.push_back(scene.model_path);
  for (std::size_t view = 0; view < scene.views.size(); ++view)
    std::ranges::copy(io::mask_files(scene, view), std::back_inserter(inputs));
  refuse_over(inputs, files, ": is an input of this run, which would replace it",
              "choose another folder for --inpaint");
}

void write_inpainting(Run& run, const Extractor& extractor, const InpaintOptions& options, const Scene& scene,
                      const std::string& folder) {
  std::filesystem::create_directories(folder + "/sparse/0");
  const GaussianCloud& cloud = extractor.cloud();
  const SplatOptions splat = prepared_for(run.exec(), splat_options({}, cloud, scene), cloud);
  const std::vector<std::uint8_t> seen = seen_gaussians(run.exec(), run.monitor(), cloud, scene, splat);
  Scene handed = scene;
  handed.model_path = folder + "/background.ply";
  handed.objects = {{"hole", 0}};
  handed.image_scale = 1;  // its photos are renders, which have the cameras' size
  handed.use_binary_masks();
  handed.void_id.reset();
  handed.missing_mask = MissingMask::kUnknown;  // settings of label maps do not apply; every view has a hole mask
  std::vector<Camera> cameras;
  Json views = Json::array();
  const std::vector<std::string> names = output_names(scene.views);
  for (SceneView& view : handed.views) {
    const auto timed = run.monitor().scope("holes");
    const ViewHole found =
        find_hole(run.exec(), options, {cloud, extractor.object(), seen, background_of(scene)}, view.camera, splat);
    const std::string& name = names[cameras.size()];
    for (const char* kind : kPictures)
      std::filesystem::create_directories(std::filesystem::path(picture_file(folder, kind, name)).parent_path());
    view.image_path = picture_file(folder, "images", name);
    view.mask_path = picture_file(folder, "dilated", name);
    io::write_png(view.image_path, to_bytes(found.colour));
    io::write_png(picture_file(folder, "holes", name), picture_of(found.hole, view.camera));
    io::write_png(view.mask_path, picture_of(found.dilated, view.camera));
    views.push_back({{"name", view.camera.name}, {"hole_pixels", std::count(found.hole.begin(), found.hole.end(), 1)}});
    cameras.push_back(view.camera);
    cameras.back().name = name + ".png";
    run.monitor().progress(std::int64_t(cameras.size()), std::int64_t(handed.views.size()));
  }
  extractor.write_background(handed.model_path);
  io::write_colmap_text(folder + "/sparse/0", cameras, {});
  io::write_scene_json(folder + "/scene.json", handed);
  run.result()["inpaint"] = {{"never_seen", std::count(seen.begin(), seen.end(), 0)}, {"views", views}};
}

}  // namespace ngs::cli
