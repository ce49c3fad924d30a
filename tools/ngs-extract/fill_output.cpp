#include "fill_output.h"

#include <algorithm>
#include <filesystem>
#include <numeric>

#include "ngs/io/formats/write_splat.h"
#include "ngs/io/ply/gaussian_columns.h"
#include "ngs/options/name_of.h"
#include "ngs/problem/cloud_rows.h"

namespace ngs::cli {
namespace {

constexpr NamedValue<TextureFill> kTextureNames[] = {{TextureFill::kNothing, "none"},
                                                     {TextureFill::kSmooth, "smooth"},
                                                     {TextureFill::kPatches, "patches"},
                                                     {TextureFill::kRepeats, "repeats"}};

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
          {"shadow_left", s.shadow.left},
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
  append(cloud.position, added.position), append(cloud.rotation, added.rotation);
  append(cloud.log_scale, added.log_scale), append(cloud.logit_opacity, added.logit_opacity);
  append(cloud.sh_dc, added.sh_dc), append(cloud.sh_rest, added.sh_rest), append(cloud.usable, added.usable);
  return cloud;
}

}  // namespace

void check_fill_options(Run& run, const FillOptions& options, const Input& inpainted, const Input& scene,
                        const Outputs& out) {
  check_inpainted_options(inpainted, scene, out);
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
  std::vector<std::string> notes;
  if (io::output_format(path) == io::SplatFormat::kPly) {
    notes = io::write_splat(path, cloud, {}, comments(), column);
    notes.push_back(io::note_of_left_columns(path, extractor_.model()));
  } else {
    notes = io::write_splat(path, {extractor_.model(), {}, &cloud, extractor_.up()});
  }
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

}  // namespace ngs::cli
