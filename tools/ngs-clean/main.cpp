// ngs-clean: splits a splat into a cleaned splat and the removed debris.
#include <algorithm>
#include <cstdio>

#include "ngs/edit/select/clean_rules.h"
#include "ngs/io/ply/gaussian_ply.h"
#include "preview.h"
#include "shared/tool.h"

namespace {

using namespace ngs;

/// A table of the Gaussians that each rule removes.
std::string table_of(const CleanFinding& finding) {
  std::string lines;
  const double total = double(std::max<std::size_t>(finding.debris.size(), 1));
  for (std::size_t kind = 1; kind <= kDebrisKinds; ++kind) {
    const bool last = kind == kDebrisKinds;
    const std::int64_t count = finding.counts[last ? 0 : kind];
    char line[80];
    std::snprintf(line, sizeof line, "%-12s %10lld  %6.2f %%\n", last ? "kept" : kDebrisNames[kind].data(),
                  static_cast<long long>(count), 100 * double(count) / total);
    lines += line;
  }
  return lines;
}

void report(cli::Run& run, const CleanFinding& finding) {
  run.text(table_of(finding));
  Json& result = run.result();
  const std::int64_t total = std::int64_t(finding.debris.size());
  result["gaussians"] = total;
  result["kept"] = finding.counts[0];
  result["removed"] = total - finding.counts[0];
  for (std::size_t kind = 1; kind < kDebrisKinds; ++kind)
    result[std::string(kDebrisNames[kind])] = finding.counts[kind];
}

void write_parts(const io::GaussianPly& ply, const CleanFinding& finding, const std::string& folder) {
  std::vector<std::uint8_t> kept(finding.debris.size()), removed(finding.debris.size());
  std::vector<float> reason(finding.debris.size());
  for (std::size_t i = 0; i < kept.size(); ++i) {
    kept[i] = finding.debris[i] == Debris::kNone;
    removed[i] = !kept[i];
    reason[i] = float(finding.debris[i]);
  }
  io::write_ply_rows(folder + "/cleaned.ply", ply, kept);
  io::write_ply_rows(folder + "/removed.ply", ply, removed, io::AddedColumn{"ngs_removed", reason});
}

std::vector<std::uint8_t> kept_rows(const CleanFinding& finding) {
  std::vector<std::uint8_t> keep;
  for (const Debris debris : finding.debris) keep.push_back(debris == Debris::kNone);
  return keep;
}

}  // namespace

int main(int argc, char** argv) {
  cli::Tool tool("ngs-clean", "Remove debris from a splat: floaters, needles, oversized and transparent Gaussians.",
                 {"ngs-clean scan.ply -o cleaned/ --preview cleaned.png", "ngs-clean scan.spz --dry-run"});
  CleanOptions options;
  tool.options(options);
  const cli::Input& model = tool.input("model", "any 3DGS model (.ply, .spz, .sog, .splat, .ksplat, .glb)");
  const cli::Output& out = tool.output_dir("-o,--output", "folder for cleaned.ply and removed.ply");
  const cli::Output& preview =
      tool.optional_output("--preview", "PNG of the scene before, after, and of the removed Gaussians");

  return tool.run(argc, argv, [&](cli::Run& run) {
    if (options.isolation == 0) run.warn_unused({"--floater-size"}, "with --isolation 0");
    const io::GaussianPly ply = [&] {
      const auto timed = run.monitor().scope("read");
      return io::read_gaussian_ply(model.path);
    }();
    for (const std::string& note : ply.notes) run.info(note);
    const CleanFinding finding = [&] {
      const auto timed = run.monitor().scope("rules");
      return find_debris(run.exec(), options, ply.cloud);
    }();
    report(run, finding);
    if (run.dry_run()) return cli::kDone;
    if (finding.counts[0] == 0)
      run.nothing_found(
          model.path + ": none of its " + std::to_string(ply.cloud.size()) + " Gaussians would be left, expected some",
          "set the threshold of the rule that removes too many to 0");
    if (preview && finding.counts[0] > 0) {
      const auto timed = run.monitor().scope("preview");
      clean::write_preview(run.exec(), ply.cloud, kept_rows(finding), preview.path);
    }
    const auto timed = run.monitor().scope("write");
    write_parts(ply, finding, out.path);
    return cli::kDone;
  });
}
