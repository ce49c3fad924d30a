#include "fill_output.h"

#include <algorithm>

#include "ngs/io/formats/write_splat.h"
#include "ngs/io/ply/gaussian_columns.h"
#include "ngs/options/name_of.h"

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
          {"texture", name_of(kTextureNames, s.texture)},
          {"rows", s.rows}};
}

/// Appends row i of `from`, which has the same degree.
void append_row(const GaussianCloud& from, std::size_t i, GaussianCloud& to) {
  const auto append = [i](const std::vector<float>& values, std::size_t width, std::vector<float>& out) {
    out.insert(out.end(), values.begin() + std::ptrdiff_t(i * width), values.begin() + std::ptrdiff_t((i + 1) * width));
  };
  append(from.position, 3, to.position), append(from.rotation, 4, to.rotation);
  append(from.log_scale, 3, to.log_scale), append(from.logit_opacity, 1, to.logit_opacity);
  append(from.sh_dc, 3, to.sh_dc), append(from.sh_rest, 3 * std::size_t(from.rest_count()), to.sh_rest);
  to.usable.push_back(from.usable[i]);
}

}  // namespace

void check_fill_options(Run& run, const FillOptions& options, const Outputs& out) {
  if (options.fill == FillKind::kOff) {
    if (out.filled) throw Error(ErrorCode::kUsage, "--filled needs a fill", "add --fill auto");
  } else if (!out.background && !out.filled) {
    run.warn_unused({"--fill"}, "without --background-ply or --filled");
  }
}

FillOutput::FillOutput(Run& run, const Extractor& extractor, const FillOptions& options)
    : run_(run), extractor_(extractor) {
  if (options.fill == FillKind::kOff) return;
  fill_ = fill_hole(run.exec(), run.monitor(), options, {extractor.cloud(), extractor.object()}, run.seed());
  Json surfaces = Json::array();
  for (const FilledSurface& s : fill_->surfaces) surfaces.push_back(surface_report(s));
  report_ = {{"kind", name_of(kFillNames, options.fill)},
             {"seed", run.seed()},
             {"rows_added", fill_->filled.size()},
             {"rows_removed", fill_->removed_rows},
             {"surfaces", surfaces}};
  run.result()["fill"] = report_;
  if (!fill_->nothing.empty()) run.result()["fill"]["nothing"] = fill_->nothing;
  run.text(fill_->nothing.empty()
               ? "filled the hole: " + std::to_string(fill_->filled.size()) +
                     " Gaussians added (invented, not measured), " + std::to_string(fill_->removed_rows) + " removed\n"
               : "filled nothing: " + fill_->nothing + "\n");
}

std::vector<std::string> FillOutput::comments() const {
  std::vector<std::string> comments;
  for (const std::string& comment : extractor_.model().comments)
    if (io::is_render_comment(comment)) comments.push_back(comment);
  comments.push_back("ngs-fill " + report_.dump());
  return comments;
}

/// Rows from `kept` on are marked as filled.
void FillOutput::write_rows(const std::string& path, const GaussianCloud& cloud, std::size_t kept) const {
  std::vector<float> filled(std::size_t(cloud.size()));
  std::fill(filled.begin() + std::ptrdiff_t(kept), filled.end(), 1.f);
  const io::AddedColumn column{std::string(io::kFilledColumn), filled};
  for (const std::string& note : io::write_splat(path, cloud, {}, comments(), column)) run_.monitor().warn(note);
}

void FillOutput::write_background(const std::string& path) const {
  if (!fill_) return extractor_.write_background(path);
  const GaussianCloud& model = extractor_.cloud();
  GaussianCloud cloud;
  cloud.origin = model.origin, cloud.sh_degree = model.sh_degree, cloud.antialiased = model.antialiased;
  for (std::size_t i = 0; i < extractor_.object().size(); ++i)
    if (!extractor_.object()[i] && !fill_->removed[i]) append_row(model, i, cloud);
  const auto kept = std::size_t(cloud.size());
  for (std::size_t i = 0; i < std::size_t(fill_->filled.size()); ++i) append_row(fill_->filled, i, cloud);
  write_rows(path, cloud, kept);
}

void FillOutput::write(const Outputs& out) const {
  if (out.background) write_background(out.background.path);
  if (out.filled) write_rows(out.filled.path, fill_->filled, 0);
}

}  // namespace ngs::cli
