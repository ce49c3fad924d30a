// ngs-report: run folders or a sweep -> one self-contained HTML page.
#include <map>

#include "ngs/core/error.h"
#include "ngs/io/files/atomic_file.h"
#include "page.h"
#include "run_folder.h"
#include "shared/cli/dispatch.h"
#include "shared/page/html.h"
#include "shared/run/report.h"
#include "shared/tool.h"
#include "sweep.h"
#include "viewer.h"

namespace {

struct ReportOptions : ngs::cli::PictureOptions {
  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    using ngs::Field;
    visit(self.crop_side_px,
          Field<int>{"crop_side", "px", "Side of the zoomed crops, in pixels of the truth", 16, 512});
    visit(self.budget_mib, Field<double>{"picture_budget", "MiB", "Size of all pictures on the page", 0, 1000});
  }
};

/// Runs with equal folder names get their paths as titles.
void make_titles_unique(std::vector<ngs::cli::RunFolder>& runs) {
  std::map<std::string, int> count;
  for (const ngs::cli::RunFolder& run : runs) ++count[run.title];
  for (ngs::cli::RunFolder& run : runs)
    if (count[run.title] > 1) run.title = run.path;
}

int runs_command(int argc, char** argv) {
  using namespace ngs;
  cli::Tool tool("ngs-report", "Show runs on one self-contained page: scores, contours, decisions, times, inputs.",
                 {"ngs-report out -o report.html", "ngs-report out/fern out/flower -o report.html"});
  ReportOptions options;
  cli::ViewerOptions viewer_options;
  tool.options(options);
  tool.options(viewer_options);
  const cli::Inputs& folders = tool.inputs("runs", "output folders of pipelines/ngs-gs.sh");
  const cli::Output& out = tool.output("-o,--output", "HTML page");
  const cli::Output& atlas = tool.optional_output_dir(
      "--atlas", "folder for pictures of wrong pixels by cause, one PNG per scored view; one run only");
  const cli::Output& viewer = tool.optional_output(
      "--viewer", "HTML page with the object in 3D; one run only; default: object.html next to -o");
  return tool.run(argc, argv, [&](cli::Run& run) {
    for (const cli::Output* output : {&atlas, &viewer})
      if (*output && folders.paths.size() > 1)
        throw Error(ErrorCode::kUsage,
                    output->flags + ": " + std::to_string(folders.paths.size()) + " runs, expected a single run",
                    "make a separate page for each run");
    std::vector<cli::RunFolder> runs;
    for (const std::string& path : folders.paths) runs.push_back(cli::read_run_folder(path));
    make_titles_unique(runs);
    run.result()["runs"] = runs.size();
    if (run.dry_run()) return 0;
    const std::string viewer_page = cli::write_viewer(run, {out, viewer, viewer_options}, runs);
    const cli::PageOutputs outputs{atlas.path,
                                   viewer_page.empty() ? std::string() : cli::address_from(out.path, viewer_page)};
    const std::string page = cli::report_page(run.exec(), runs, options, outputs);
    io::write_file(out.path, page);
    for (const cli::RunFolder& folder : runs) {
      for (const std::string& problem : folder.problems) run.monitor().warn(problem);
      run.result()["means"].push_back({{"run", folder.title},
                                       {"method", cli::method_of(folder)},
                                       {"wall_s", cli::run_seconds(folder)},
                                       {"mean", cli::value_at(folder.metrics, {"mean"})}});
    }
    run.result()["mean_over_runs"] = cli::means_json(runs);
    run.result()["bytes"] = page.size();
    if (runs.size() > 1 || cli::stage_of_chain().empty())
      run.text(cli::means_table(runs));  // a chain already printed it
    return 0;
  });
}

}  // namespace

int main(int argc, char** argv) {
  return ngs::cli::dispatch(
      argc, argv,
      {{"", runs_command, "the folders of runs"},
       {"work-precision", ngs::cli::work_precision_command, "a sweep of pipelines/work-precision.mk"}});
}
